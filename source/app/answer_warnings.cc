#include <slipstick/app/answer_warnings.h>
#include <slipstick/app/curve_warnings.h>
#include <slipstick/base/log.h>
#include <slipstick/mechanics/deformation.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace slipstick::app
{
  namespace
  {
    // Strains and rotations [rad] above which the linear theory is wrong by some percent.
    constexpr double largest_strain = 0.1, largest_rotation = 0.1;
    // Displacements that are more than this part of the diagonal of a body.
    constexpr double largest_motion = 0.5;
    // Young modulus above that of any material (diamond: 1.2e6 MPa) ...
    constexpr double largest_modulus = 1e7;
    // ... which may be meant as rigid; but not of all bodies if all displacements are below this part of the bodies'
    // diagonals.
    constexpr double least_motion = 1e-8;
    // Contact pressure over the smaller Young modulus of the two sides.
    constexpr double largest_pressure = 1;
    // Overlap and slip over the length of an edge.
    constexpr double largest_step = 1;

    /// Of one contact pair: the largest value, where it is, and the length of the longest edge.
    struct OfPair
    {
      double overlap = 0, overlap_x = 0, overlap_y = 0;
      double slip = 0, slip_x = 0, slip_y = 0;
      double pressure = 0, pressure_x = 0, pressure_y = 0;
      double edge = 0;
    };
    constexpr unsigned int n_numbers = 10;

    using Triple = std::array<double OfPair::*, 3>;
    const Triple overlap_of{{&OfPair::overlap, &OfPair::overlap_x, &OfPair::overlap_y}};
    const Triple slip_of{{&OfPair::slip, &OfPair::slip_x, &OfPair::slip_y}};
    const Triple pressure_of{{&OfPair::pressure, &OfPair::pressure_x, &OfPair::pressure_y}};

    void take(OfPair &pair, const Triple &member, const double value, const double x, const double y)
    {
      if (value > pair.*member[0])
        {
          pair.*member[0] = value;
          pair.*member[1] = x;
          pair.*member[2] = y;
        }
    }

    std::vector<OfPair> over_all_ranks(const std::vector<OfPair> &own, const MPI_Comm comm)
    {
      std::vector<double> numbers;
      for (const auto &o : own)
        numbers.insert(numbers.end(),
                       {o.overlap,
                        o.overlap_x,
                        o.overlap_y,
                        o.slip,
                        o.slip_x,
                        o.slip_y,
                        o.pressure,
                        o.pressure_x,
                        o.pressure_y,
                        o.edge});
      std::vector<OfPair> all(own.size());
      for (const auto &of_rank : dealii::Utilities::MPI::all_gather(comm, numbers))
        for (unsigned int k = 0; k < own.size(); ++k)
          {
            const double *n = of_rank.data() + n_numbers * k;
            take(all[k], overlap_of, n[0], n[1], n[2]);
            take(all[k], slip_of, n[3], n[4], n[5]);
            take(all[k], pressure_of, n[6], n[7], n[8]);
            all[k].edge = std::max(all[k].edge, n[9]);
          }
      return all;
    }

    std::vector<OfPair> peaks_of_pairs(const scene::Scene<2>                   &scene,
                                       const tfeti::Constraints                &constraints,
                                       const std::vector<contact::ContactNode> &nodes,
                                       const MPI_Comm                           comm)
    {
      std::vector<OfPair> own(scene.contacts.size());
      for (unsigned int i = 0; i < constraints.contact_points.size(); ++i)
        {
          const auto  &point = constraints.contact_points[i];
          const auto  &node  = nodes[i];
          auto        &pair  = own[point.pair];
          const double x = point.position[0], y = point.position[1];
          take(pair, overlap_of, -point.gap, x, y);
          take(pair, pressure_of, node.pressure, x, y);
          if (point.has_master && node.is_closed)
            take(pair, slip_of, std::abs(node.slip), x, y);
          pair.edge = std::max(pair.edge, point.traction_length);
        }
      return over_all_ranks(own, comm);
    }

    double modulus(const scene::Scene<2> &scene, const scene::ContactPair<2> &pair)
    {
      const auto of = [&](const unsigned int body) {
        return scene.materials[scene.bodies[body].material].young_modulus;
      };
      return pair.master ? std::min(of(pair.slave.body), of(pair.master->body)) : of(pair.slave.body);
    }

    /// Pairs between which forces can be exchanged without effect, and the first place; empty if there are none.
    /// Collective.
    std::string split_warning(const scene::Scene<2>    &scene,
                              const tfeti::DualProblem &dual,
                              const std::vector<bool>  &free)
    {
      const auto                          ambiguous = dual.ambiguous(free);
      std::set<unsigned int>              pairs;
      std::set<std::pair<double, double>> places;
      for (const auto *points : {&dual.constraints().contact_points, &dual.constraints().bonded_points})
        for (const auto &point : *points)
          for (const unsigned int row : {point.normal_row, point.tangential_row})
            if (row != tfeti::invalid_row && ambiguous[row])
              {
                pairs.insert(point.pair);
                places.insert({point.position[0], point.position[1]});
              }
      for (const auto &of_rank :
           dealii::Utilities::MPI::all_gather(dual.communicator(),
                                              std::vector<unsigned int>(pairs.begin(), pairs.end())))
        pairs.insert(of_rank.begin(), of_rank.end());
      std::vector<double> own;
      for (const auto &[x, y] : places)
        own.insert(own.end(), {x, y});
      for (const auto &of_rank : dealii::Utilities::MPI::all_gather(dual.communicator(), own))
        for (unsigned int i = 0; i < of_rank.size(); i += 2)
          places.insert({of_rank[i], of_rank[i + 1]});
      if (pairs.empty())
        return "";
      std::string names;
      for (const unsigned int pair : pairs)
        names += (names.empty() ? "" : ", ") + scene.contacts[pair].name;
      return format(
        "Contact %s: at %zu points, the first at (%.6g, %.6g), the bodies that stick together there hold each other in more "
        "than one way, so that only the sums of the forces are determined, not their distribution over these "
        "pairs and supports; leave out one of the pairs or nodes, or use the sums only",
        names.c_str(),
        places.size(),
        places.begin()->first,
        places.begin()->second);
    }

    std::string place(const scene::Scene<2> &scene, const mechanics::Peak<2> &peak)
    {
      return format("of body %s at (%.6g, %.6g)",
                    scene.bodies[peak.body].name.c_str(),
                    peak.position[0],
                    peak.position[1]);
    }
  } // namespace

  std::map<std::string, std::string> answer_warnings(const scene::Scene<2>                   &scene,
                                                     const mesh::Mesh<2>                     &mesh,
                                                     const mechanics::Spaces<2>              &spaces,
                                                     const tfeti::DualProblem                &dual,
                                                     const std::vector<bool>                 &free,
                                                     const std::vector<contact::ContactNode> &nodes,
                                                     const std::vector<Eigen::VectorXd>      &u)
  {
    std::map<std::string, std::string> texts;
    const auto                         pairs = peaks_of_pairs(scene, dual.constraints(), nodes, mesh.comm);
    if (const std::string text = split_warning(scene, dual, free); !text.empty())
      texts["split"] = text;
    texts.merge(curve_warnings(scene, mesh, spaces, dual.constraints().contact_points, nodes));
    for (unsigned int k = 0; k < pairs.size(); ++k)
      {
        const auto        &pair = pairs[k];
        const std::string &name = scene.contacts[k].name;
        if (pair.overlap > largest_step * pair.edge)
          texts["overlap " + name] =
            format("Contact %s: its sides overlap by %.4g mm at (%.6g, %.6g), more than an edge of %.4g mm; check the "
                   "positions of the bodies, Offset and Gap",
                   name.c_str(),
                   pair.overlap,
                   pair.overlap_x,
                   pair.overlap_y,
                   pair.edge);
        if (pair.slip > largest_step * pair.edge)
          texts["slip " + name] = format(
            "Contact %s: its sides slide by %.4g mm at (%.6g, %.6g), more than an edge of %.4g mm, but contact is "
            "found in the undeformed positions; check loads and supports",
            name.c_str(),
            pair.slip,
            pair.slip_x,
            pair.slip_y,
            pair.edge);
        if (pair.pressure > largest_pressure * modulus(scene, scene.contacts[k]))
          texts["pressure " + name] =
            format("Contact %s: the pressure of %.4g MPa at (%.6g, %.6g) is above the Young modulus of %.4g MPa; check "
                   "the units of loads, overlaps and moduli",
                   name.c_str(),
                   pair.pressure,
                   pair.pressure_x,
                   pair.pressure_y,
                   modulus(scene, scene.contacts[k]));
      }
    const auto        large = mechanics::largest_deformation(scene, mesh, spaces, u);
    const char *const remedy =
      "the linear theory of small displacements does not hold there; check loads, moduli and units";
    if (large.strain.value > largest_strain)
      texts["strain"] =
        format("the strain %s is %.3g: %s", place(scene, large.strain).c_str(), large.strain.value, remedy);
    if (large.rotation.value > largest_rotation)
      texts["rotation"] =
        format("the rotation %s is %.3g rad: %s", place(scene, large.rotation).c_str(), large.rotation.value, remedy);
    if (large.motion.value > largest_motion)
      texts["motion"] = format(
        "the displacement %s is %.3g times the size of the body, but contact is found in the undeformed positions; "
        "check gaps, loads and supports",
        place(scene, large.motion).c_str(),
        large.motion.value);
    double least_modulus = std::numeric_limits<double>::infinity();
    for (const auto &body : scene.bodies)
      least_modulus = std::min(least_modulus, scene.materials[body.material].young_modulus);
    if (least_modulus > largest_modulus && large.motion.value > 0 && large.motion.value < least_motion)
      texts["moduli"] = format(
        "the displacement of no body is more than %.1e of its size, and no Young modulus is below %.3g MPa (diamond "
        "has 1.2e+06): are the moduli given in Pa, lengths and loads in mm and N? check the units",
        large.motion.value,
        least_modulus);
    return texts;
  }
} // namespace slipstick::app
