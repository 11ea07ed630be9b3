#include <slipstick/app/curve_warnings.h>
#include <slipstick/app/solution_warnings.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/contact/holding_forces.h>
#include <slipstick/mechanics/deformation.h>
#include <slipstick/tfeti/diagnosis.h>

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
    // Strains and rotations [rad] above which the linear theory has errors of a few percent.
    constexpr double largest_strain = 0.1, largest_rotation = 0.1;
    // Ratio of displacement to the diagonal of a body.
    constexpr double largest_motion = 0.5;
    // Young's modulus above that of any material (diamond: 1.2e6 MPa) ...
    constexpr double largest_modulus = 1e7;
    // ... which may be intended as rigid; but not for all bodies if all displacements are below this fraction of the
    // bodies' diagonals.
    constexpr double least_motion = 1e-8;
    // Ratio of contact pressure to the smaller Young's modulus of the two sides.
    constexpr double largest_pressure = 1;
    // Ratio of overlap and slip to the length of an edge.
    constexpr double largest_step = 1;
    // Ratio of the moment that displacements leave of balanced forces to the moments that hold a body.
    constexpr double largest_moment = 0.02;

    /// A maximum and its place.
    struct Largest
    {
      double                value = 0;
      std::array<double, 3> at{{0, 0, 0}};

      void take(const double other, const double *x)
      {
        if (!(other > value))
          return;
        value = other;
        std::copy_n(x, at.size(), at.begin());
      }
    };

    /// Maxima for one contact pair, with the length of the longest edge.
    struct OfPair
    {
      Largest overlap, slip, pressure, bridged;
      double  edge = 0;

      std::array<Largest *, 4> values()
      {
        return {{&overlap, &slip, &pressure, &bridged}};
      }
    };

    std::vector<OfPair> over_all_ranks(std::vector<OfPair> own, const MPI_Comm comm)
    {
      std::vector<double> numbers;
      for (auto &o : own)
        {
          for (const Largest *one : o.values())
            numbers.insert(numbers.end(), {one->value, one->at[0], one->at[1], one->at[2]});
          numbers.push_back(o.edge);
        }
      std::vector<OfPair> all(own.size());
      for (const auto &of_rank : all_gather(comm, numbers))
        {
          const double *n = of_rank.data();
          for (auto &pair : all)
            {
              for (Largest *one : pair.values())
                {
                  one->take(n[0], n + 1);
                  n += 1 + one->at.size();
                }
              pair.edge = std::max(pair.edge, *n++);
            }
        }
      return all;
    }

    template <int dim>
    std::vector<OfPair> peaks_of_pairs(const scene::Scene<dim>                 &scene,
                                       const tfeti::Constraints                &constraints,
                                       const std::vector<contact::ContactNode> &nodes,
                                       const MPI_Comm                           comm)
    {
      std::vector<OfPair> own(scene.contacts.size());
      for (unsigned int i = 0; i < constraints.contact_points.size(); ++i)
        {
          const auto &point = constraints.contact_points[i];
          const auto &node  = nodes[i];
          auto       &pair  = own[point.pair];
          const auto *x     = point.position.data();
          pair.overlap.take(-point.gap, x);
          pair.pressure.take(node.pressure, x);
          if (point.has_master && node.is_closed)
            pair.slip.take(std::abs(node.slip), x);
          pair.edge = std::max(pair.edge, dim == 2 ? point.traction_length : std::sqrt(point.traction_length));
        }
      for (const auto &point : constraints.bonded_points)
        {
          auto &pair = own[point.pair];
          pair.bridged.take(std::abs(point.gap), point.position.data());
          pair.edge = std::max(pair.edge, dim == 2 ? point.traction_length : std::sqrt(point.traction_length));
        }
      return over_all_ranks(own, comm);
    }

    template <int dim>
    double modulus(const scene::Scene<dim> &scene, const scene::ContactPair<dim> &pair)
    {
      const auto of = [&](const unsigned int body) {
        return scene.materials[scene.bodies[body].material].young_modulus;
      };
      return pair.master ? std::min(of(pair.slave.body), of(pair.master->body)) : of(pair.slave.body);
    }

    /// Pairs between which forces can be exchanged without effect, and the first such place; empty if there are none.
    /// Collective.
    template <int dim>
    std::string split_warning(const scene::Scene<dim>  &scene,
                              const tfeti::DualProblem &dual,
                              const std::vector<bool>  &free)
    {
      const auto                      ambiguous = tfeti::ambiguous(dual, free);
      std::set<unsigned int>          pairs;
      std::set<std::array<double, 3>> places;
      for (const auto *points : {&dual.constraints().contact_points, &dual.constraints().bonded_points})
        for (const auto &point : *points)
          for (const unsigned int row : {point.normal_row, point.tangential_row, point.second_row})
            if (row != tfeti::invalid_row && ambiguous[row])
              {
                pairs.insert(point.pair);
                places.insert(point.position);
              }
      for (const auto &of_rank : all_gather(dual.communicator(), std::vector<unsigned int>(pairs.begin(), pairs.end())))
        pairs.insert(of_rank.begin(), of_rank.end());
      std::vector<double> own;
      for (const auto &x : places)
        own.insert(own.end(), x.begin(), x.end());
      for (const auto &of_rank : all_gather(dual.communicator(), own))
        for (unsigned int i = 0; i < of_rank.size(); i += 3)
          places.insert(std::array<double, 3>{{of_rank[i], of_rank[i + 1], of_rank[i + 2]}});
      if (pairs.empty())
        return "";
      std::string names;
      for (const unsigned int pair : pairs)
        names += (names.empty() ? "" : ", ") + scene.contacts[pair].name;
      return format(
        "Contact %s: at %zu points, the first at %s, the bodies that stick together there hold each other in more "
        "than one way, so that only the sums of the forces are determined, not their distribution over these "
        "pairs and supports; leave out one of the pairs or nodes, or use the sums only",
        names.c_str(),
        places.size(),
        point_text(*places.begin(), dim).c_str());
    }

    /// Bodies whose forces leave a moment where the displacements take them, for instance those that roll away. Bodies
    /// with initial strains are left out: their loads contain forces that are in balance with stresses. Collective.
    template <int dim>
    std::map<std::string, std::string> balance_warnings(const scene::Scene<dim>            &scene,
                                                        const tfeti::DualProblem           &dual,
                                                        const tfeti::DistributedVector     &multipliers,
                                                        const std::vector<Eigen::VectorXd> &u)
    {
      std::map<std::string, std::string> texts;
      if (scene.plane_state == scene::PlaneState::axisymmetric)
        return texts;
      std::set<unsigned int> with_initial_strains;
      for (const auto &temperature : scene.temperatures)
        with_initial_strains.insert(temperature.bodies.begin(), temperature.bodies.end());
      for (const auto &pretension : scene.pretensions)
        with_initial_strains.insert(pretension.body);
      const auto   moments = contact::displaced_moments(dual, u, multipliers, scene.bodies.size());
      const double noise   = qp::force_rounding * moments.forces.maxCoeff();
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        if (with_initial_strains.count(b) == 0 && moments.forces[b] > noise &&
            moments.left[b] > largest_moment * moments.holding[b])
          texts["balance " + scene.bodies[b].name] = format(
            "Body %s: its forces balance where they act on the undeformed body, but where the displacements take "
            "them they leave a moment of %.3g N mm, %.2g times the moments that hold it: it may roll or tip "
            "further than the theory of small displacements says; hold it, or reduce the loads",
            scene.bodies[b].name.c_str(),
            moments.left[b],
            moments.left[b] / moments.holding[b]);
      return texts;
    }

    template <int dim>
    std::string place(const scene::Scene<dim> &scene, const mechanics::Peak<dim> &peak)
    {
      return "of body " + scene.bodies[peak.body].name + " at " + point_text(peak.position, dim);
    }
  } // namespace

  template <int dim>
  std::map<std::string, std::string> solution_warnings(const scene::Scene<dim>                 &scene,
                                                       const mesh::Mesh<dim>                   &mesh,
                                                       const mechanics::Spaces<dim>            &spaces,
                                                       const tfeti::DualProblem                &dual,
                                                       const tfeti::DistributedVector          &multipliers,
                                                       const std::vector<bool>                 &free,
                                                       const std::vector<contact::ContactNode> &nodes,
                                                       const std::vector<Eigen::VectorXd>      &u)
  {
    std::map<std::string, std::string> texts;
    const auto                         pairs = peaks_of_pairs(scene, dual.constraints(), nodes, mesh.comm);
    if (const std::string text = split_warning(scene, dual, free); !text.empty())
      texts["split"] = text;
    texts.merge(balance_warnings(scene, dual, multipliers, u));
    texts.merge(curve_warnings(scene, mesh, spaces, dual.constraints().contact_points, nodes));
    for (unsigned int k = 0; k < pairs.size(); ++k)
      {
        const auto        &pair = pairs[k];
        const std::string &name = scene.contacts[k].name;
        if (pair.overlap.value > largest_step * pair.edge)
          texts["overlap " + name] =
            format("Contact %s: its sides overlap by %.4g mm at %s, more than an edge of %.4g mm; check the "
                   "positions of the bodies, Offset and Gap",
                   name.c_str(),
                   pair.overlap.value,
                   point_text(pair.overlap.at, dim).c_str(),
                   pair.edge);
        if (pair.bridged.value > largest_step * pair.edge)
          texts["bridged " + name] = format(
            "Contact %s: it bonds across a gap of %.4g mm at %s, more than an edge of %.4g mm; shorten its Reach, "
            "or bond the part of the boundary that touches (where)",
            name.c_str(),
            pair.bridged.value,
            point_text(pair.bridged.at, dim).c_str(),
            pair.edge);
        if (pair.slip.value > largest_step * pair.edge)
          texts["slip " + name] =
            format("Contact %s: its sides slide by %.4g mm at %s, more than an edge of %.4g mm, but contact is "
                   "found in the undeformed positions; check loads and supports",
                   name.c_str(),
                   pair.slip.value,
                   point_text(pair.slip.at, dim).c_str(),
                   pair.edge);
        if (pair.pressure.value > largest_pressure * modulus(scene, scene.contacts[k]))
          texts["pressure " + name] =
            format("Contact %s: the pressure of %.4g MPa at %s is above the Young modulus of %.4g MPa; check "
                   "the units of loads, overlaps and moduli",
                   name.c_str(),
                   pair.pressure.value,
                   point_text(pair.pressure.at, dim).c_str(),
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

  template std::map<std::string, std::string> solution_warnings(const scene::Scene<2> &,
                                                                const mesh::Mesh<2> &,
                                                                const mechanics::Spaces<2> &,
                                                                const tfeti::DualProblem &,
                                                                const tfeti::DistributedVector &,
                                                                const std::vector<bool> &,
                                                                const std::vector<contact::ContactNode> &,
                                                                const std::vector<Eigen::VectorXd> &);
  template std::map<std::string, std::string> solution_warnings(const scene::Scene<3> &,
                                                                const mesh::Mesh<3> &,
                                                                const mechanics::Spaces<3> &,
                                                                const tfeti::DualProblem &,
                                                                const tfeti::DistributedVector &,
                                                                const std::vector<bool> &,
                                                                const std::vector<contact::ContactNode> &,
                                                                const std::vector<Eigen::VectorXd> &);
} // namespace slipstick::app
