// Names of free rigid motions.
#include <slipstick/base/log.h>
#include <slipstick/tfeti/rigid_motions.h>

namespace slipstick::tfeti
{
  namespace
  {
    // A component of a motion is named if it is at least this part of the largest.
    constexpr double named_part = 1e-3;
    // A motion is called a rotation if the rotation moves the rim of the body by at least this part of the translation.
    constexpr double turning_part = 0.02;
    // Loads push along a motion if their work is at least this part of its maximum over all directions.
    constexpr double least_work = 1e-9;
    // Coordinates below this part of a body's size are zero.
    constexpr double negligible_coordinate = 1e-4;

    std::string number(const double coordinate, const double length)
    {
      return format("%.4g", std::abs(coordinate) < negligible_coordinate * length ? 0. : coordinate);
    }

    std::string direction(const Eigen::Vector3d &v)
    {
      const Eigen::Vector3d unit = (v.array().abs() < named_part * v.norm()).select(0., v.normalized());
      return format("(%.3g, %.3g, %.3g)", unit[0], unit[1], unit[2]);
    }

    /// Motion of one body: t + w x (x - centre) / length, w along the axis of a rotation.
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
        else // point where u = t + rotation (-(y - y_c), x - x_c) / length vanishes
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
        result[m].work       = 0; // not computed
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

  void require_support(const std::vector<RigidMotion> &motions, const std::vector<std::string> &body_names)
  {
    if (motions.empty())
      return;
    const auto        motion = plainest(motions);
    const std::string text   = "nothing holds " + describe(motion, body_names);
    const std::string others = motions.size() > 1 ? format(" (one of %zu free motions)", motions.size()) : "";
    const std::string remedy = "add a support or a contact that acts against this motion";
    if (motion.work > 0)
      throw DrivenMotions(text + ", where the loads push" + others, remedy, motions, motion.work);
    throw UnheldMotions(text + "; no load acts along it, but the position is not determined" + others, remedy, motions);
  }
} // namespace slipstick::tfeti
