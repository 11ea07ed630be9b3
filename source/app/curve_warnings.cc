#include <slipstick/app/curve_warnings.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/body_contact.h>
#include <slipstick/mesh/smooth_outline.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    // Limit on the neglected sagitta, relative to the reference length. Waves of height w and the wave length h of an
    // edge are pressed flat by a pressure of pi E' w / (2 h) (Johnson 1985, section 13.2); this is therefore about the
    // relative error of the pressure.
    constexpr double largest_share = 0.1;

    /// 1/E' = 1/E of one side + 1/E of the other.
    template <int dim>
    double modulus_of_both(const scene::Scene<dim> &scene, const scene::ContactPair<dim> &pair)
    {
      const auto of = [&](const unsigned int body) {
        return scene.materials[scene.bodies[body].material].young_modulus;
      };
      return 1 / (1 / of(pair.slave.body) + 1 / of(pair.master->body));
    }

    /// Largest pressures and smallest gaps of the pairs over all ranks.
    std::vector<std::array<double, 2>> extremes(const std::size_t                        n_pairs,
                                                const std::vector<tfeti::ContactPoint>  &points,
                                                const std::vector<contact::ContactNode> &nodes,
                                                const MPI_Comm                           comm)
    {
      std::vector<double> largest(2 * n_pairs, 0.);
      for (unsigned int k = 0; k < n_pairs; ++k)
        largest[2 * k + 1] = -std::numeric_limits<double>::max();
      for (unsigned int i = 0; i < points.size(); ++i)
        {
          auto *const of_pair = largest.data() + 2 * points[i].pair;
          of_pair[0]          = std::max(of_pair[0], nodes[i].pressure);
          of_pair[1]          = std::max(of_pair[1], -std::abs(points[i].gap));
        }
      std::vector<double> all(largest.size());
      dealii::Utilities::MPI::max(largest, comm, all);
      std::vector<std::array<double, 2>> result;
      for (unsigned int k = 0; k < n_pairs; ++k)
        result.push_back({{all[2 * k], -all[2 * k + 1]}});
      return result;
    }

    template <int dim>
    std::string text_of(const scene::ContactPair<dim> &pair, const std::vector<double> &worst, const bool is_closed)
    {
      if constexpr (dim == 3)
        return format(
          "Contact %s: at %s plane faces deviate by %.4g mm from a curved surface, which is not small compared with %s of %.4g mm, "
          "so that pressures are those of a polyhedron; use a mesh of second order (built-in shapes: Outline = smooth), or a finer "
          "one",
          pair.name.c_str(),
          point_text(dealii::Point<3>(worst[1], worst[2], worst[5]), 3).c_str(),
          worst[3],
          is_closed ? "the deformation" : "the gap",
          worst[4]);
      return format(
        "Contact %s: at (%.6g, %.6g) straight edges deviate by %.4g mm from an arc, which is not small compared with %s "
        "of %.4g mm, so that pressures are those of a polygon; set Outline = smooth or a larger Corner angle for the "
        "bodies, or use a finer mesh or one of second order (if the corners are intended, the pressures are, too)",
        pair.name.c_str(),
        worst[1],
        worst[2],
        worst[3],
        is_closed ? "the deformation" : "the gap",
        worst[4]);
    }
  } // namespace

  template <int dim>
  std::map<std::string, std::string> curve_warnings(const scene::Scene<dim>                 &scene,
                                                    const mesh::Mesh<dim>                   &mesh,
                                                    const mechanics::Spaces<dim>            &spaces,
                                                    const std::vector<tfeti::ContactPoint>  &points,
                                                    const std::vector<contact::ContactNode> &nodes)
  {
    std::map<std::string, std::string> texts;
    if (!mesh::leaves_out_curves(mesh)) // the usual case
      return texts;
    std::map<std::pair<unsigned int, mechanics::NodeKey>, double> neglected_sagitta;
    const auto contacts = interface::pair_bodies(scene, mesh, spaces);
    for (unsigned int k = 0; k < contacts.rows.size(); ++k)
      for (const auto &row : contacts.rows[k])
        neglected_sagitta[{k, row.slave}] = std::max(neglected_sagitta[{k, row.slave}], row.neglected_sagitta);
    const auto of_pair = extremes(scene.contacts.size(), points, nodes, mesh.comm);
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      {
        const auto &pair = scene.contacts[k];
        if (!pair.master || pair.law.is_bonded)
          continue;
        const auto [pressure, gap] = of_pair[k];
        std::vector<double> worst(dim + 3, 0.); // relative sagitta, place, sagitta, reference length; z
        for (unsigned int i = 0; i < points.size(); ++i)
          if (points[i].pair == k && (pressure == 0 || nodes[i].is_closed))
            {
              const double length = dim == 3 ? std::sqrt(points[i].area) : points[i].length;
              const double scale =
                pressure > 0 ? 2 * length * pressure / (dealii::numbers::PI * modulus_of_both(scene, pair)) : gap;
              const double sagitta = neglected_sagitta[{k, points[i].key}];
              if (sagitta > largest_share * scale && sagitta / scale > worst[0])
                {
                  worst = {sagitta / scale, points[i].position[0], points[i].position[1], sagitta, scale};
                  if (dim == 3)
                    worst.push_back(points[i].position[2]);
                }
            }
        for (const auto &of_rank : all_gather(mesh.comm, worst))
          worst = std::max(worst, of_rank);
        if (worst[0] > 0)
          texts["curves " + pair.name] = text_of(pair, worst, pressure > 0);
      }
    return texts;
  }

  template std::map<std::string, std::string> curve_warnings(const scene::Scene<2> &,
                                                             const mesh::Mesh<2> &,
                                                             const mechanics::Spaces<2> &,
                                                             const std::vector<tfeti::ContactPoint> &,
                                                             const std::vector<contact::ContactNode> &);
  template std::map<std::string, std::string> curve_warnings(const scene::Scene<3> &,
                                                             const mesh::Mesh<3> &,
                                                             const mechanics::Spaces<3> &,
                                                             const std::vector<tfeti::ContactPoint> &,
                                                             const std::vector<contact::ContactNode> &);
} // namespace slipstick::app
