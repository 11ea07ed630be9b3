#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/held_contact.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    // Support and contact agree if they differ by less than this fraction of the larger of both displacements ...
    constexpr double same_gap = 1e-6;
    // ... or, without displacements, of the tributary length of the node: files give coordinates with about seven
    // digits.
    constexpr double digits_of_files = 1e-6;
    // Rounding of coordinates in gaps, relative to the coordinates.
    constexpr double rounding_of_coordinates = 1e-12;

    template <int dim>
    std::string names_of(const scene::Scene<dim> &scene, const std::vector<unsigned int> &holders)
    {
      std::string names;
      for (const unsigned int h : holders)
        if (h < scene.supports.size())
          names += (names.empty() ? "Support " : ", Support ") + scene.supports[h].name;
        else if (h == scene.supports.size() + scene.foundations.size() + scene.contacts.size())
          names += names.empty() ? "the axis of revolution" : ", the axis of revolution";
        else if (h >= scene.supports.size() + scene.foundations.size())
          names += (names.empty() ? "bonded Contact " : ", bonded Contact ") +
                   scene.contacts[h - scene.supports.size() - scene.foundations.size()].name;
      return names.empty() ? "a bond" : names;
    }

    template <int dim>
    NoEquilibrium prescribed_penetration(const scene::Scene<dim>          &scene,
                                         const tfeti::HeldContacts::Point &point,
                                         const double                      depth)
    {
      const auto &pair = scene.contacts[point.contact.pair];
      std::string direction; // the sum avoids -0
      for (unsigned int d = 0; d < dim; ++d)
        direction += format("%s%.3g", d == 0 ? "(" : ", ", point.contact.normal[d] + 0.);
      direction += ")";
      const std::string other = pair.master ? "body " + scene.bodies[pair.master->body].name
                                            : "obstacle " + scene.obstacles[pair.obstacle].name;
      return NoEquilibrium(
        format("%s and Contact %s contradict each other: at %s body %s is held %.6g mm inside %s, which no "
               "force can change",
               names_of(scene, point.holders).c_str(),
               pair.name.c_str(),
               point_text(point.contact.position, dim).c_str(),
               scene.bodies[pair.slave.body].name.c_str(),
               depth,
               other.c_str()),
        "prescribe no more than the gap there, free the displacement along " + direction +
          ", leave the supported boundary out of the contact, or change its Offset or Gap");
    }

    /// Throws for the deepest point, taken from the first rank that has it. Collective.
    template <int dim, class Depth>
    void refuse_deepest(const scene::Scene<dim>   &scene,
                        const tfeti::HeldContacts &held,
                        const Depth               &depth_of,
                        const MPI_Comm             comm)
    {
      double       deepest = 0;
      unsigned int which   = tfeti::invalid_row;
      for (unsigned int i = 0; i < held.points.size(); ++i)
        if (const double depth = depth_of(i);
            !held.points[i].is_bonded && depth > held_contact_tolerance(held.points[i]) && depth > deepest)
          {
            deepest = depth;
            which   = i;
          }
      const double largest = dealii::Utilities::MPI::max(deepest, comm);
      collectively(comm, [&] {
        if (largest > 0 && deepest == largest)
          throw prescribed_penetration(scene, held.points[which], deepest);
      });
    }
  } // namespace

  double held_contact_tolerance(const tfeti::HeldContacts::Point &point)
  {
    double coordinates = 0;
    for (const double x : point.contact.position)
      coordinates = std::max(coordinates, std::abs(x));
    const bool is_moved = point.is_known && point.closing != 0;
    return rounding_of_coordinates * coordinates +
           (is_moved ? same_gap * std::max(std::abs(point.closing), std::abs(point.contact.gap))
                     : digits_of_files * point.contact.length);
  }

  template <int dim>
  void refuse_held_penetration(const scene::Scene<dim> &scene, const tfeti::HeldContacts &held, const MPI_Comm comm)
  {
    refuse_deepest(
      scene,
      held,
      [&](const unsigned int i) {
        const auto &point = held.points[i];
        return point.is_known ? point.closing - point.contact.gap : 0.;
      },
      comm);
  }

  template <int dim>
  void refuse_held_penetration(const scene::Scene<dim>   &scene,
                               const tfeti::HeldContacts &held,
                               const std::vector<double> &gaps,
                               const double               noise,
                               const MPI_Comm             comm)
  {
    refuse_deepest(
      scene,
      held,
      [&](const unsigned int i) { return held.points[i].is_known ? 0. : -gaps[i] - noise; },
      comm);
  }

  template void refuse_held_penetration(const scene::Scene<2> &, const tfeti::HeldContacts &, const MPI_Comm);
  template void refuse_held_penetration(const scene::Scene<2> &,
                                        const tfeti::HeldContacts &,
                                        const std::vector<double> &,
                                        const double,
                                        const MPI_Comm);
  template void refuse_held_penetration(const scene::Scene<3> &, const tfeti::HeldContacts &, const MPI_Comm);
  template void refuse_held_penetration(const scene::Scene<3> &,
                                        const tfeti::HeldContacts &,
                                        const std::vector<double> &,
                                        const double,
                                        const MPI_Comm);
} // namespace slipstick::interface
