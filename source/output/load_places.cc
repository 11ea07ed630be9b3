#include <slipstick/base/across.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/gather.h>
#include <slipstick/output/load_places.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipstick::output
{
  namespace
  {
    // Places are rounded to this fraction of the size of their body, so that they do not depend on the decomposition.
    constexpr double grain = 0x1p-30;

    template <int dim, class F>
    void for_each_cell(const mesh::Mesh<dim> &mesh, const unsigned int body, const F &f)
    {
      for (const auto &subdomain : mesh.subdomains)
        if (subdomain->body == body)
          for (const auto &cell : subdomain->triangulation.active_cell_iterators())
            f(cell);
    }

    /// Smallest and largest of a set of numbers over all ranks.
    struct Range
    {
      double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();

      void add(const double x)
      {
        low  = std::min(low, x);
        high = std::max(high, x);
      }
      void reduce(const MPI_Comm comm)
      {
        low  = dealii::Utilities::MPI::min(low, comm);
        high = dealii::Utilities::MPI::max(high, comm);
      }
      bool holds(const double x) const
      {
        return low <= x && x <= high;
      }
    };

    /// Extent of a body along a direction, measured from a point.
    template <int dim>
    Range reach(const mesh::Mesh<dim>        &mesh,
                const unsigned int            body,
                const dealii::Point<dim>     &from,
                const dealii::Tensor<1, dim> &along)
    {
      Range range;
      for_each_cell(mesh, body, [&](const auto &cell) {
        for (const unsigned int v : cell->vertex_indices())
          range.add((cell->vertex(v) - from) * along);
      });
      range.reduce(mesh.comm);
      return range;
    }

    template <int dim>
    std::array<Range, dim> box_of(const mesh::Mesh<dim> &mesh, const unsigned int body)
    {
      std::array<Range, dim> box;
      for (unsigned int d = 0; d < dim; ++d)
        {
          dealii::Tensor<1, dim> axis;
          axis[d] = 1;
          box[d]  = reach(mesh, body, dealii::Point<dim>(), axis);
        }
      return box;
    }

    /// Rounds to a multiple of a power of 2; most coordinates are such multiples.
    double rounded(const double x, const double size)
    {
      const double unit = std::exp2(std::floor(std::log2(size * grain)));
      return std::round(x / unit) * unit;
    }

    /// The centre of gravity of a body if it is inside the body (in the bounding box of a cell), otherwise the centre
    /// of the nearest cell (the first of several).
    template <int dim>
    dealii::Point<dim> middle_of(const mesh::Mesh<dim> &mesh, const unsigned int body)
    {
      const auto box  = box_of(mesh, body);
      double     size = 0;
      for (const Range &range : box)
        size = std::max(size, range.high - range.low);
      std::vector<double> sums(dim + 1);
      for_each_cell(mesh, body, [&](const auto &cell) {
        const double volume = cell->measure();
        for (unsigned int d = 0; d < dim; ++d)
          sums[d] += volume * cell->center()[d];
        sums[dim] += volume;
      });
      dealii::Utilities::MPI::sum(sums, mesh.comm, sums);
      dealii::Point<dim> centre;
      for (unsigned int d = 0; d < dim; ++d)
        centre[d] = rounded(sums[d] / sums[dim], size);

      using Candidate = std::array<double, dim + 1>; // distance and place
      Candidate best;
      best.fill(std::numeric_limits<double>::max());
      for_each_cell(mesh, body, [&](const auto &cell) {
        bool is_inside = true;
        for (unsigned int d = 0; d < dim; ++d)
          {
            Range of_cell;
            for (const unsigned int v : cell->vertex_indices())
              of_cell.add(cell->vertex(v)[d]);
            is_inside = is_inside && of_cell.holds(centre[d]);
          }
        const auto place = is_inside ? centre : cell->center();
        Candidate  candidate;
        candidate[0] = rounded(place.distance(centre), size);
        for (unsigned int d = 0; d < dim; ++d)
          candidate[d + 1] = rounded(place[d], size);
        best = std::min(best, candidate);
      });
      for (const Candidate &candidate : all_gather(mesh.comm, best))
        best = std::min(best, candidate);
      for (unsigned int d = 0; d < dim; ++d)
        centre[d] = best[d + 1];
      return centre;
    }

    /// The load step with the largest @p size; steps in which a formula cannot be evaluated are skipped, since the
    /// solver reports them.
    template <class F, class Size>
    auto largest(const std::vector<double> &load_factors, const F &value_at, const Size &size)
    {
      std::decay_t<decltype(value_at(0.))> result{};
      for (const double t : load_factors)
        try
          {
            if (const auto value = value_at(t); size(value) > size(result))
              result = value;
          }
        catch (const InputError &)
          {}
      return result;
    }

    template <class F>
    double largest(const std::vector<double> &load_factors, const F &value_at)
    {
      return largest(load_factors, value_at, [](const double x) { return std::abs(x); });
    }

    template <int dim>
    dealii::Tensor<1, dim> vector_at(const std::array<scene::Field<dim>, dim> &fields,
                                     const dealii::Point<dim>                 &x,
                                     const double                              t)
    {
      dealii::Tensor<1, dim> v;
      for (unsigned int c = 0; c < dim; ++c)
        v[c] = fields[c].value(x, t);
      return v;
    }

    /// Ends of the line through a point across a body.
    template <int dim>
    std::vector<dealii::Point<dim>> line_through(const mesh::Mesh<dim>        &mesh,
                                                 const unsigned int            body,
                                                 const dealii::Point<dim>     &point,
                                                 const dealii::Tensor<1, dim> &along)
    {
      const Range range = reach(mesh, body, point, along);
      return {point + range.low * along, point + range.high * along};
    }

    /// Axis of rotation of a body; in the plane a point.
    template <int dim>
    std::vector<dealii::Point<dim>> axis_of(const scene::Scene<dim>     &scene,
                                            const mesh::Mesh<dim>       &mesh,
                                            const scene::BodyForce<dim> &load,
                                            const unsigned int           body)
    {
      dealii::Tensor<1, dim> along;
      if (dim == 2 && scene.plane_state == scene::PlaneState::axisymmetric)
        {
          along[1] = 1;
          return line_through(mesh, body, dealii::Point<dim>(), along);
        }
      if (dim == 2)
        return {load.axis};
      along = load.axis_direction;
      if (along.norm() == 0)
        along[dim - 1] = 1;
      return line_through(mesh, body, load.axis, along / along.norm());
    }

    /// Intersection of the section of a bolt with the edges of the cells: in the plane the ends of the cut, in space
    /// the corners of its bounding rectangle.
    template <int dim>
    std::vector<dealii::Point<dim>> section_of(const mesh::Mesh<dim> &mesh, const scene::Pretension<dim> &bolt)
    {
      const auto                 sides = across(bolt.direction);
      std::array<Range, dim - 1> ranges;
      for_each_cell(mesh, bolt.body, [&](const auto &cell) {
        for (unsigned int e = 0; e < cell->n_lines(); ++e)
          {
            const auto   a = cell->line(e)->vertex(0), b = cell->line(e)->vertex(1);
            const double above_a = (a - bolt.point) * bolt.direction, above_b = (b - bolt.point) * bolt.direction;
            if (above_a == above_b || (above_a > 0) == (above_b > 0))
              continue;
            const auto cut = a + above_a / (above_a - above_b) * (b - a);
            for (unsigned int k = 0; k < dim - 1; ++k)
              ranges[k].add((cut - bolt.point) * sides[k]);
          }
      });
      for (Range &range : ranges)
        range.reduce(mesh.comm);
      const auto at = [&](const double first, const double second) {
        auto point = bolt.point + first * sides.front();
        if (dim == 3)
          point += second * sides.back();
        return point;
      };
      const Range &first = ranges.front(), &second = ranges.back();
      if (dim == 2)
        return {at(first.high, 0), at(first.low, 0)};
      return {at(first.low, second.low),
              at(first.high, second.low),
              at(first.high, second.high),
              at(first.low, second.high)};
    }

    template <int dim>
    class Places
    {
    public:
      Places(const scene::Scene<dim> &scene_, const mesh::Mesh<dim> &mesh_)
        : scene(scene_)
        , mesh(mesh_)
      {}

      void add(const scene::BodyForce<dim> &load)
      {
        for (const unsigned int body : load.bodies)
          {
            const auto             middle  = middle_of(mesh, body);
            const double           density = scene.materials[scene.bodies[body].material].density;
            dealii::Tensor<1, dim> force   = largest(
              scene.load_factors,
              [&](const double t) {
                return vector_at<dim>(load.force, middle, t) + density * vector_at<dim>(load.acceleration, middle, t);
              },
              [](const dealii::Tensor<1, dim> &v) { return v.norm(); });
            const double turning =
              largest(scene.load_factors, [&](const double t) { return load.angular_velocity.value(load.axis, t); });
            if (force.norm() > 0 || turning == 0)
              all.push_back({"body force", load.name, "", body, {middle}, force, force.norm()});
            if (turning != 0)
              all.push_back({"body force", load.name, "axis", body, axis_of(scene, mesh, load, body), {}, turning});
          }
      }

      void add(const scene::Temperature<dim> &heat)
      {
        for (const unsigned int body : heat.bodies)
          {
            const auto   middle = middle_of(mesh, body);
            const double change =
              largest(scene.load_factors, [&](const double t) { return heat.change.value(middle, t); });
            all.push_back({"temperature", heat.name, "", body, {middle}, {}, change});
          }
      }

      void add(const scene::Pretension<dim> &bolt)
      {
        const double tension = largest(scene.load_factors, [&](const double t) {
          return t <= bolt.tightened_until ? bolt.force.value(bolt.point, t) : 0.;
        });
        all.push_back({"pretension", bolt.name, "section", bolt.body, section_of(mesh, bolt), {}, tension});
        all.push_back({"pretension",
                       bolt.name,
                       "axis",
                       bolt.body,
                       line_through(mesh, bolt.body, bolt.point, bolt.direction),
                       {},
                       tension});
      }

      std::vector<LoadPlace<dim>> all;

    private:
      const scene::Scene<dim> &scene;
      const mesh::Mesh<dim>   &mesh;
    };
  } // namespace

  template <int dim>
  std::vector<LoadPlace<dim>> load_places(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh)
  {
    Places<dim> places(scene, mesh);
    for (const auto &load : scene.body_forces)
      places.add(load);
    for (const auto &heat : scene.temperatures)
      places.add(heat);
    for (const auto &bolt : scene.pretensions)
      places.add(bolt);
    return std::move(places.all);
  }

  template std::vector<LoadPlace<2>> load_places(const scene::Scene<2> &, const mesh::Mesh<2> &);
  template std::vector<LoadPlace<3>> load_places(const scene::Scene<3> &, const mesh::Mesh<3> &);
} // namespace slipstick::output
