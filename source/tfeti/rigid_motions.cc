#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/tfeti/null_vectors.h>
#include <slipstick/tfeti/rigid_motions.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace slipstick::tfeti
{
  namespace
  {
    // Resultants below this part of the sum of magnitudes are rounding of zero.
    constexpr double rounding_of_loads = 1e-12;
    // Resistance of rigid rows, relative to the resistance to the best held motion.
    constexpr double weight_of_rigid_rows = 1e6;

    /// Frames of all bodies, each taken from a rank that has a subdomain of the body.
    std::vector<BodyFrame> frames_of_bodies(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                                            const unsigned int                                   n_bodies,
                                            const MPI_Comm                                       comm)
    {
      constexpr unsigned int n = 4; // numbers per frame
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

    /// Contribution of a body to the jumps of a row under its motions.
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

    /// Sums of loads along rigid motions, and of their magnitudes.
    struct SumsOfLoads
    {
      explicit SumsOfLoads(const Eigen::Index n_motions)
        : values(Eigen::MatrixXd::Zero(n_motions, 2))
      {}

      /// @param motions displacements of all unknowns, one column per motion.
      void add(const Eigen::Index first_motion, const Eigen::MatrixXd &motions, const Eigen::VectorXd &load)
      {
        values.col(0).segment(first_motion, motions.cols()) += motions.transpose() * load;
        values.col(1).segment(first_motion, motions.cols()) += motions.cwiseAbs().transpose() * load.cwiseAbs();
      }

      /// The sums; 0 where the loads cancel to rounding.
      Eigen::VectorXd without_rounding() const
      {
        return (values.col(0).array().abs() <= rounding_of_loads * values.col(1).array()).select(0., values.col(0));
      }

      Eigen::MatrixXd values;
    };

    bool is_gluing(const Constraints &constraints, const unsigned int owned_row)
    {
      return constraints.kind[owned_row] == RowKind::gluing;
    }

    /// Parts of all rows that this rank owns, except gluing rows, sorted by row.
    std::vector<RowPart> parts_of_owned_rows(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
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
          for (const auto &entry : constraints.blocks[p])
            {
              if (entry.row < n_owned && is_gluing(constraints, entry.row))
                continue;
              const Eigen::VectorXd share = entry.value * motions.row(entry.dof).transpose();
              RowPart               part;
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
      std::stable_sort(own.begin(), own.end(), [](const auto &a, const auto &b) {
        return std::tie(a.row, a.body) < std::tie(b.row, b.body);
      });
      std::vector<RowPart> sums; // one for every row and body
      for (auto &part : own)
        if (sums.empty() || sums.back().row != part.row || sums.back().body != part.body)
          sums.push_back(std::move(part));
        else
          for (std::size_t k = 0; k < part.values.size(); ++k)
            sums.back().values[k] += part.values[k];
      return sums;
    }
  } // namespace

  BodyMotions::BodyMotions(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains_,
                           const Constraints                                   &constraints,
                           const std::vector<std::string>                      &names,
                           const MPI_Comm                                       comm_)
    : subdomains(subdomains_)
    , names_of_bodies(names)
    , comm(comm_)
    , n_owned_rows(constraints.kind.size())
    , motions_of_body(
        dealii::Utilities::MPI::max(subdomains.empty() ? 0u : static_cast<unsigned int>(subdomains[0]->kernel().cols()),
                                    comm))
    , n_motions(motions_of_body * names.size())
    , frames(frames_of_bodies(subdomains, names.size(), comm))
  {
    for (const auto &part : parts_of_owned_rows(subdomains, constraints, comm))
      shares.push_back({constraints.rows->global_to_local(part.row),
                        part.body,
                        Eigen::Map<const Eigen::VectorXd>(part.values.data(), part.values.size())});
  }

  // Sum over rows of the outer product of their jumps with themselves; complete on every rank, summed in the order of
  // the ranks.
  Eigen::SparseMatrix<double> BodyMotions::resistance_of(const std::vector<bool>  &active,
                                                         const std::vector<Share> &of_rows) const
  {
    std::map<std::pair<unsigned int, unsigned int>, Eigen::MatrixXd> own;
    for (auto begin = of_rows.begin(); begin != of_rows.end();)
      {
        const auto end =
          std::find_if(begin, of_rows.end(), [row = begin->row](const Share &share) { return share.row != row; });
        if (active.empty() || active[begin->row])
          for (auto a = begin; a != end; ++a)
            for (auto b = begin; b != end; ++b)
              {
                const Eigen::MatrixXd block = a->values * b->values.transpose();
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
    for (const auto &of_rank : all_gather(comm, numbers))
      for (std::size_t at = 0; at < of_rank.size(); at += 2 + n * n)
        for (std::size_t k = 0; k < n * n; ++k)
          entries.emplace_back(of_rank[at] * n + k % n, of_rank[at + 1] * n + k / n, of_rank[at + 2 + k]);
    Eigen::SparseMatrix<double> result(n_motions, n_motions);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  // Shares of all rows, with those of turned rows transformed.
  std::vector<BodyMotions::Share> BodyMotions::turned(const std::vector<qp::Turn> &turns) const
  {
    std::map<unsigned int, std::vector<Share>> others; // of the turned rows
    const auto                                 of_row = [this](const unsigned int row) {
      return std::equal_range(shares.begin(), shares.end(), Share{row, 0, {}}, [](const Share &a, const Share &b) {
        return a.row < b.row;
      });
    };
    for (const qp::Turn &turn : turns)
      for (const auto &[row, of_first, of_second] :
           {std::tuple(turn.first, turn.cosine, turn.sine), std::tuple(turn.second, -turn.sine, turn.cosine)})
        for (const auto &[from, factor] : {std::pair(turn.first, of_first), std::pair(turn.second, of_second)})
          for (auto [share, end] = of_row(from); share != end; ++share)
            others[row].push_back({static_cast<unsigned int>(row), share->body, factor * share->values});
    std::vector<Share> result;
    for (const Share &share : shares)
      if (others.count(share.row) == 0)
        result.push_back(share);
    for (auto &[row, of_this] : others)
      std::move(of_this.begin(), of_this.end(), std::back_inserter(result));
    std::stable_sort(result.begin(), result.end(), [](const Share &a, const Share &b) { return a.row < b.row; });
    return result;
  }

  // Returns orthonormal motions.
  std::vector<Eigen::VectorXd> BodyMotions::unresisted(const std::vector<bool>  &active,
                                                       const double              resistance,
                                                       const std::vector<bool>  &rigid,
                                                       const std::vector<Share> &of_rows) const
  {
    const bool                  has_rigid = dealii::Utilities::MPI::max(rigid.empty() ? 0 : 1, comm) > 0;
    Eigen::SparseMatrix<double> all       = resistance_of(active, of_rows);
    const double                largest   = std::max(largest_eigenvalue(all), 1.);
    if (has_rigid)
      all += weight_of_rigid_rows * largest * resistance_of(rigid, of_rows);
    return null_vectors(all, resistance * largest);
  }

  std::vector<RigidMotion> BodyMotions::free(const std::vector<bool>     &active,
                                             const double                 resistance,
                                             const std::vector<qp::Turn> &turns,
                                             const std::vector<bool>     &rigid) const
  {
    std::vector<RigidMotion> motions;
    for (auto &amplitudes : unresisted(active, resistance, rigid, turns.empty() ? shares : turned(turns)))
      motions.push_back({std::move(amplitudes), 0., frames});
    if (motions.empty()) // the usual case; avoids computing the loads
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
    SumsOfLoads sums(n_motions);
    for (const auto &subdomain : subdomains)
      {
        const Eigen::MatrixXd modes = subdomain->kernel() * subdomain->body_modes();
        const Eigen::Index    first = subdomain->body() * motions_of_body;
        sums.add(first, modes, subdomain->load());
      }
    MPI_Allreduce(MPI_IN_PLACE, sums.values.data(), sums.values.size(), MPI_DOUBLE, MPI_SUM, comm);
    return sums.without_rounding();
  }

  Eigen::VectorXd BodyMotions::loads_of_subdomains() const
  {
    const Eigen::VectorXd of_bodies   = loads();
    const auto            is_balanced = [&](const SubdomainSystem &subdomain) {
      return of_bodies.segment(subdomain.body() * motions_of_body, motions_of_body).isZero(0.);
    };
    std::vector<Eigen::VectorXd> own;                           // by subdomain
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n_motions, 2); // of balanced bodies; numbers of subdomains
    for (const auto &subdomain : subdomains)
      {
        if (!is_balanced(*subdomain))
          {
            own.emplace_back(subdomain->kernel().transpose() * subdomain->load());
            continue;
          }
        SumsOfLoads of_this(motions_of_body);
        of_this.add(0, subdomain->kernel(), subdomain->load());
        own.push_back(of_this.without_rounding());
        const Eigen::Index first = subdomain->body() * motions_of_body;
        sums.col(0).segment(first, motions_of_body) += subdomain->body_modes().transpose() * own.back();
        sums.col(1).segment(first, motions_of_body).array() += 1;
      }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), sums.size(), MPI_DOUBLE, MPI_SUM, comm);
    Eigen::VectorXd result(motions_of_body * subdomains.size());
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      {
        const auto        &subdomain = *subdomains[p];
        const Eigen::Index first     = subdomain.body() * motions_of_body;
        if (is_balanced(subdomain))
          own[p] -= subdomain.body_modes().transpose().partialPivLu().solve(
            (sums.col(0).segment(first, motions_of_body).array() / sums.col(1).segment(first, motions_of_body).array())
              .matrix());
        result.segment(p * motions_of_body, motions_of_body) = own[p];
      }
    return result;
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
} // namespace slipstick::tfeti
