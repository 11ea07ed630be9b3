#include <slipstick/base/log.h>
#include <slipstick/tfeti/null_vectors.h>
#include <slipstick/tfeti/rigid_motions.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <limits>
#include <map>
#include <utility>

namespace slipstick::tfeti
{
  namespace
  {
    // A component of a motion is named when it is at least this part of the largest.
    constexpr double named_part = 1e-3;
    // A motion is called a rotation when that moves the rim of the body by this part of the translation or more.
    constexpr double turning_part = 0.02;
    // Loads push along a motion when their work is at least this part of what it could be.
    constexpr double least_work = 1e-9;
    // Rows are moved by a translation when that gives more than this part of what it gives with one body.
    constexpr double rounding_of_translation = 1e-9;
    // What is left of a vector of unit length that others contain, but for rounding of eigenvectors.
    constexpr double rounding_of_vectors = 1e-6;
    // Resultants below this part of the sum of magnitudes are rounding of none.
    constexpr double rounding_of_loads = 1e-13;
    // Coordinates below this part of a body's size are zero.
    constexpr double negligible_coordinate = 1e-4;

    std::string number(const double coordinate, const double length)
    {
      return format("%.4g", std::abs(coordinate) < negligible_coordinate * length ? 0. : coordinate);
    }

    /// Frames of all bodies, from the rank that has a subdomain of it.
    std::vector<BodyFrame> frames_of_bodies(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                                            const unsigned int                                   n_bodies,
                                            const MPI_Comm                                       comm)
    {
      constexpr unsigned int n = 4; // numbers a frame
      std::vector<double>    all(n * n_bodies, std::numeric_limits<double>::lowest());
      for (const auto &subdomain : subdomains)
        {
          const BodyFrame &frame = subdomain->body_frame();
          std::copy(frame.center.begin(), frame.center.end(), all.begin() + n * subdomain->body());
          all[n * subdomain->body() + n - 1] = frame.length;
        }
      MPI_Allreduce(MPI_IN_PLACE, all.data(), all.size(), MPI_DOUBLE, MPI_MAX, comm);
      std::vector<BodyFrame> frames(n_bodies);
      for (unsigned int b = 0; b < n_bodies; ++b)
        {
          std::copy_n(all.begin() + n * b, n - 1, frames[b].center.begin());
          frames[b].length = all[n * b + n - 1];
        }
      return frames;
    }

    /// Contribution of one subdomain to the jumps of a row under the motions of its body.
    struct RowPart
    {
      std::uint64_t       row  = 0; // global
      unsigned int        body = 0;
      std::vector<double> values;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &row &body &values;
      }
    };

    bool is_gluing(const Constraints &constraints, const unsigned int owned_row)
    {
      return constraints.kind[owned_row] == RowKind::gluing;
    }

    /// Parts of all rows that this rank owns, gluing left out.
    std::vector<RowPart> parts_of_owned_rows(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                                             const std::vector<LocalGluing>                      &gluing,
                                             const Constraints                                   &constraints,
                                             const MPI_Comm                                       comm)
    {
      const auto                                   owner_of_ghost = owners_of_ghosts(constraints.rows);
      const unsigned int                           n_owned        = constraints.rows->locally_owned_size();
      std::map<unsigned int, std::vector<RowPart>> to_send;
      std::vector<RowPart>                         own;
      for (unsigned int p = 0; p < subdomains.size(); ++p)
        {
          const Eigen::MatrixXd motions = subdomains[p]->kernel() * subdomains[p]->body_modes();
          for (const auto &entry : gluing[p].entries)
            {
              if (entry.row < n_owned && is_gluing(constraints, entry.row))
                continue;
              const Eigen::VectorXd share =
                entry.value * motions.row(subdomains[p]->touched()[entry.touched]).transpose();
              RowPart part;
              part.row  = constraints.rows->local_to_global(entry.row);
              part.body = subdomains[p]->body();
              part.values.assign(share.data(), share.data() + share.size());
              (entry.row < n_owned ? own : to_send[owner_of_ghost[entry.row - n_owned]]).push_back(std::move(part));
            }
        }
      for (auto &[rank, parts] : dealii::Utilities::MPI::some_to_some(comm, to_send))
        for (auto &part : parts)
          if (!is_gluing(constraints, constraints.rows->global_to_local(part.row)))
            own.push_back(std::move(part));
      std::sort(own.begin(), own.end(), [](const auto &a, const auto &b) { return a.row < b.row; });
      return own;
    }
  } // namespace

  BodyMotions::BodyMotions(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains_,
                           const std::vector<LocalGluing>                      &gluing,
                           const Constraints                                   &constraints,
                           const unsigned int                                   n_bodies,
                           const MPI_Comm                                       comm_)
    : subdomains(subdomains_)
    , comm(comm_)
    , n_owned_rows(constraints.kind.size())
    , motions_of_body(
        dealii::Utilities::MPI::max(subdomains.empty() ? 0u : static_cast<unsigned int>(subdomains[0]->kernel().cols()),
                                    comm))
    , n_motions(motions_of_body * n_bodies)
    , frames(frames_of_bodies(subdomains, n_bodies, comm))
  {
    for (const auto &part : parts_of_owned_rows(subdomains, gluing, constraints, comm))
      shares.push_back({constraints.rows->global_to_local(part.row),
                        part.body,
                        Eigen::Map<const Eigen::VectorXd>(part.values.data(), part.values.size())});
    find_levers();
  }

  // What a rotation of all bodies of a row about one point makes of it. A row that translations in common do not move
  // either is one between bodies.
  void BodyMotions::find_levers()
  {
    if (motions_of_body != 3) // bodies of revolution do not rotate; solids do so about three axes
      return;
    for (auto begin = shares.begin(); begin != shares.end();)
      {
        const auto end =
          std::find_if(begin, shares.end(), [row = begin->row](const Share &share) { return share.row != row; });
        Eigen::VectorXd translation = Eigen::VectorXd::Zero(motions_of_body - 1);
        double          rotation = 0, size = 0;
        for (auto share = begin; share != end; ++share)
          {
            const BodyFrame &frame = frames[share->body];
            translation += share->values.head(motions_of_body - 1);
            rotation += frame.center[0] * share->values[1] - frame.center[1] * share->values[0] +
                        frame.length * share->values[motions_of_body - 1];
            size = std::max(size, share->values.head(motions_of_body - 1).norm());
          }
        const bool is_between = std::any_of(begin, end, [&](const Share &share) { return share.body != begin->body; });
        if (is_between && translation.norm() <= rounding_of_translation * size)
          begin->lever = rotation / frames[begin->body].length;
        begin = end;
      }
  }

  // Sum over rows of what they see of the motions, times itself; whole on every rank, summed in the order of the ranks.
  Eigen::SparseMatrix<double> BodyMotions::resistance_of(const std::vector<bool> &active,
                                                         const bool               without_levers) const
  {
    const auto at_one_point = [without_levers](const Share &share) {
      Eigen::VectorXd values = share.values;
      if (without_levers)
        values[values.size() - 1] -= share.lever;
      return values;
    };
    std::map<std::pair<unsigned int, unsigned int>, Eigen::MatrixXd> own;
    for (auto begin = shares.begin(); begin != shares.end();)
      {
        const auto end =
          std::find_if(begin, shares.end(), [row = begin->row](const Share &share) { return share.row != row; });
        if (active.empty() || active[begin->row])
          for (auto a = begin; a != end; ++a)
            for (auto b = begin; b != end; ++b)
              {
                const Eigen::MatrixXd block = at_one_point(*a) * at_one_point(*b).transpose();
                const auto [place, is_new]  = own.emplace(std::pair(a->body, b->body), block);
                if (!is_new)
                  place->second += block;
              }
        begin = end;
      }
    std::vector<double> numbers; // of every block: bodies, entries
    for (const auto &[bodies, block] : own)
      {
        numbers.insert(numbers.end(), {double(bodies.first), double(bodies.second)});
        numbers.insert(numbers.end(), block.data(), block.data() + block.size());
      }
    const std::size_t                   n = motions_of_body;
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto &of_rank : dealii::Utilities::MPI::all_gather(comm, numbers))
      for (std::size_t at = 0; at < of_rank.size(); at += 2 + n * n)
        for (std::size_t k = 0; k < n * n; ++k)
          entries.emplace_back(of_rank[at] * n + k % n, of_rank[at + 1] * n + k / n, of_rank[at + 2 + k]);
    Eigen::SparseMatrix<double> result(n_motions, n_motions);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  // Orthonormal.
  std::vector<Eigen::VectorXd> BodyMotions::unresisted(const std::vector<bool> &active, const double resistance) const
  {
    const auto null_vectors_of = [&](const bool without_levers) {
      const Eigen::SparseMatrix<double> all = resistance_of(active, without_levers);
      return null_vectors(all, resistance * std::max(largest_eigenvalue(all), 1.));
    };
    std::vector<Eigen::VectorXd> result = null_vectors_of(false);
    if (dealii::Utilities::MPI::min(active.empty() ? 1 : 0, comm) == 0) // a rank may have no rows
      return result;
    for (auto &vector :
         null_vectors_of(true)) // these need not contain the first: a row without its lever may resist more
      {
        for (unsigned int pass = 0; pass < 2; ++pass) // the second for what the first leaves by rounding
          for (const auto &other : result)
            vector -= other.dot(vector) * other;
        if (vector.norm() > rounding_of_vectors)
          result.push_back(vector.normalized());
      }
    return result;
  }

  std::vector<RigidMotion> BodyMotions::free(const std::vector<bool> &active, const double resistance) const
  {
    std::vector<RigidMotion> motions;
    for (auto &amplitudes : unresisted(active, resistance))
      motions.push_back({std::move(amplitudes), 0., frames});
    if (motions.empty()) // as nearly always: the loads are not asked
      return motions;
    const Eigen::VectorXd load = loads();
    for (auto &motion : motions)
      {
        motion.load = motion.amplitudes.dot(load);
        motion.work = load.norm() > 0 ? motion.load / load.norm() : 0.;
      }
    return motions;
  }

  Eigen::VectorXd BodyMotions::loads() const
  {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n_motions, 2); // of the loads, and of their magnitudes
    for (const auto &subdomain : subdomains)
      {
        const Eigen::MatrixXd modes = subdomain->kernel() * subdomain->body_modes();
        const Eigen::Index    first = subdomain->body() * motions_of_body;
        sums.col(0).segment(first, motions_of_body) += modes.transpose() * subdomain->load();
        sums.col(1).segment(first, motions_of_body) += modes.cwiseAbs().transpose() * subdomain->load().cwiseAbs();
      }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), sums.size(), MPI_DOUBLE, MPI_SUM, comm);
    return (sums.col(0).array().abs() <= rounding_of_loads * sums.col(1).array()).select(0., sums.col(0));
  }

  Eigen::SparseMatrix<double, Eigen::RowMajor> BodyMotions::jumps(const std::vector<RigidMotion> &motions) const
  {
    std::vector<Eigen::Triplet<double>> of_rows, of_motions;
    for (const Share &share : shares)
      for (unsigned int k = 0; k < motions_of_body; ++k)
        of_rows.emplace_back(share.row, share.body * motions_of_body + k, share.values[k]);
    for (unsigned int m = 0; m < motions.size(); ++m)
      for (unsigned int k = 0; k < n_motions; ++k)
        if (motions[m].amplitudes[k] != 0)
          of_motions.emplace_back(k, m, motions[m].amplitudes[k]);
    Eigen::SparseMatrix<double, Eigen::RowMajor> rows(n_owned_rows, n_motions), amplitudes(n_motions, motions.size());
    rows.setFromTriplets(of_rows.begin(), of_rows.end());
    amplitudes.setFromTriplets(of_motions.begin(), of_motions.end());
    return rows * amplitudes;
  }

  Eigen::VectorXd BodyMotions::displacements(const unsigned int p, const Eigen::VectorXd &amplitudes) const
  {
    const auto &subdomain = *subdomains[p];
    return subdomain.kernel() *
           (subdomain.body_modes() * amplitudes.segment(subdomain.body() * motions_of_body, motions_of_body));
  }

  RigidMotion body_motion(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                          const Eigen::VectorXd                               &amplitudes,
                          const unsigned int                                   n_bodies,
                          const MPI_Comm                                       comm)
  {
    const unsigned int k =
      dealii::Utilities::MPI::max(subdomains.empty() ? 0u : static_cast<unsigned int>(subdomains[0]->kernel().cols()),
                                  comm);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(k * n_bodies);
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      sum.segment(subdomains[p]->body() * k, k) += subdomains[p]->body_modes().inverse() * amplitudes.segment(p * k, k);
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), sum.size(), MPI_DOUBLE, MPI_SUM, comm);
    return {sum.normalized(), 0., frames_of_bodies(subdomains, n_bodies, comm)};
  }

  namespace
  {
    std::string direction(const Eigen::Vector3d &v)
    {
      const Eigen::Vector3d unit = (v.array().abs() < named_part * v.norm()).select(0., v.normalized());
      return format("(%.3g, %.3g, %.3g)", unit[0], unit[1], unit[2]);
    }

    /// Of one body: t + w x (x - centre) / length, w along the axis of a rotation.
    std::string in_space(const Eigen::VectorXd &part, const BodyFrame &frame)
    {
      const Eigen::Vector3d t = part.head<3>(), w = part.tail<3>();
      if (w.norm() < turning_part * t.norm())
        return "translation along " + direction(t);
      const Eigen::Vector3d at_axis = frame.length / w.squaredNorm() * w.cross(t); // from the centre
      std::string           point;
      for (unsigned int d = 0; d < 3; ++d)
        point += (d == 0 ? "" : ", ") + number(frame.center[d] + at_axis[d], frame.length);
      const bool is_screw = std::abs(t.dot(w)) > turning_part * w.squaredNorm();
      return "rotation about the axis along " + direction(w) + " through (" + point + ")" +
             (is_screw ? " with a translation along it" : "");
    }
  } // namespace

  std::string describe(const RigidMotion &motion, const std::vector<std::string> &body_names)
  {
    const unsigned int k       = motion.amplitudes.size() / body_names.size();
    const double       largest = motion.amplitudes.cwiseAbs().maxCoeff();
    std::string        text;
    for (unsigned int b = 0; b < body_names.size(); ++b)
      {
        const Eigen::VectorXd part = (motion.amplitudes.segment(b * k, k).array().abs() < named_part * largest)
                                       .select(0., motion.amplitudes.segment(b * k, k)); // without rounding
        if (part.cwiseAbs().maxCoeff() < named_part * largest)
          continue;
        text += (text.empty() ? "body " : "; body ") + body_names[b] + ": ";
        if (k == 1)
          {
            text += "translation along the axis";
            continue;
          }
        if (is_solid(k))
          {
            text += in_space(part, motion.frames[b]);
            continue;
          }
        const Eigen::VectorXd translation = part.head(n_translations(k));
        const double          rotation    = part[k - 1];
        if (std::abs(rotation) < turning_part * translation.norm())
          text += format("translation along (%.3g, %.3g)",
                         translation[0] / translation.norm(),
                         translation[1] / translation.norm());
        else // u = t + rotation (-(y - y_c), x - x_c) / length vanishes there
          {
            const BodyFrame &frame = motion.frames[b];
            text += format("rotation about (%s, %s)",
                           number(frame.center[0] - translation[1] / rotation * frame.length, frame.length).c_str(),
                           number(frame.center[1] + translation[0] / rotation * frame.length, frame.length).c_str());
          }
      }
    return text;
  }

  std::vector<RigidMotion> disentangled(const std::vector<RigidMotion> &motions)
  {
    Eigen::MatrixXd basis(motions.size(), motions.front().amplitudes.size());
    for (unsigned int m = 0; m < motions.size(); ++m)
      basis.row(m) = motions[m].amplitudes;
    Eigen::Index next = 0;
    for (Eigen::Index column = 0; column < basis.cols() && next < basis.rows(); ++column)
      {
        Eigen::Index pivot;
        if (basis.col(column).tail(basis.rows() - next).cwiseAbs().maxCoeff(&pivot) < named_part)
          continue;
        basis.row(next).swap(basis.row(next + pivot));
        basis.row(next) /= basis(next, column);
        for (Eigen::Index row = 0; row < basis.rows(); ++row)
          if (row != next)
            basis.row(row) -= basis(row, column) * basis.row(next);
        ++next;
      }
    std::vector<RigidMotion> result(motions);
    for (unsigned int m = 0; m < result.size(); ++m)
      {
        result[m].amplitudes = basis.row(m).normalized();
        result[m].work       = 0; // not told
        result[m].load       = 0;
      }
    return result;
  }

  RigidMotion plainest(const std::vector<RigidMotion> &motions)
  {
    RigidMotion pushed = motions.front();
    pushed.amplitudes.setZero();
    for (const auto &motion : motions)
      pushed.amplitudes += motion.work * motion.amplitudes;
    pushed.work = pushed.amplitudes.norm();
    if (pushed.work > least_work)
      {
        pushed.amplitudes.normalize();
        return pushed;
      }
    RigidMotion result = motions.front();
    result.work        = 0;
    Eigen::Index least = result.amplitudes.size() + 1;
    for (const auto &motion : disentangled(motions))
      {
        const Eigen::Index moved = (motion.amplitudes.array().abs() >= named_part).count();
        if (moved < least)
          {
            least             = moved;
            result.amplitudes = motion.amplitudes;
          }
      }
    return result;
  }
} // namespace slipstick::tfeti
