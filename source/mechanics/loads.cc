#include <slipstick/base/collective.h>
#include <slipstick/base/gather.h>
#include <slipstick/mechanics/adaptive_cubature.h>
#include <slipstick/mechanics/adaptive_quadrature.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/points.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/mechanics/volume_load.h>
#include <slipstick/mesh/kinematics.h>

#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>

namespace slipstick::mechanics
{
  namespace
  {
    // Admissible difference of two quadratures, summed over cells (and faces of solids), relative to the force.
    constexpr double allowed_difference = 0.01;

    /// One subdomain and its load at load factor t.
    template <int dim>
    class SubdomainLoad
    {
    public:
      SubdomainLoad(const scene::Scene<dim> &scene_,
                    const mesh::Mesh<dim>   &mesh_,
                    const Spaces<dim>       &spaces_,
                    const unsigned int       p,
                    const double             t_)
        : scene(scene_)
        , mesh(mesh_)
        , subdomain(*mesh.subdomains[p])
        , spaces(spaces_)
        , element(spaces.of(p))
        , sums(scene.tractions.size() + scene.body_forces.size())
        , differences_of_tractions(scene.tractions.size())
        , dof_handler(*spaces.dof_handlers[p])
        , number(mesh.subdomains[p]->body)
        , body(scene.bodies[number])
        , kinematics(scene.plane_state)
        , t(t_)
        , volume(scene, mesh, spaces, p, t)
        , load(Eigen::VectorXd::Zero(dof_handler.n_dofs()))
      {
        add_tractions();
        volume.add_to(load, sums);
      }

      Eigen::VectorXd take()
      {
        return std::move(load);
      }

      /// Resultants of tractions and body forces on this subdomain.
      const std::vector<LoadResultant> &resultants() const
      {
        return sums;
      }

      /// Quadrature differences: tractions given by formulas in space, then body forces.
      std::vector<QuadratureDifference> differences()
      {
        std::vector<QuadratureDifference> all = differences_of_tractions, others = volume.differences();
        all.insert(all.end(), others.begin(), others.end());
        return all;
      }

    private:
      using Vector = dealii::Tensor<1, dim>;
      using Face   = typename dealii::DoFHandler<dim>::active_face_iterator;

      /// Thickness, or circumference at @p x [mm].
      double weight(const dealii::Point<dim> &x) const
      {
        return body.thickness * kinematics.measure(x);
      }

      void add(const unsigned int node, const Vector &force)
      {
        for (unsigned int c = 0; c < dim; ++c)
          load[dim * node + c] += force[c];
      }

      Vector vector(const std::array<scene::Field<dim>, dim> &fields, const dealii::Point<dim> &x) const
      {
        Vector v;
        for (unsigned int c = 0; c < dim; ++c)
          v[c] = fields[c].value(x, t);
        return v;
      }

      void add_tractions()
      {
        const bool any = std::any_of(scene.tractions.begin(), scene.tractions.end(), [this](const auto &traction) {
          return traction.where.body == number;
        });
        if (!any)
          return;
        dealii::FEFaceValues<dim> values(*element.mapping,
                                         *element.scalar,
                                         element.face_quadrature(element.degree + 2),
                                         dealii::update_values | dealii::update_quadrature_points |
                                           dealii::update_normal_vectors | dealii::update_JxW_values);
        for (const auto &cell : dof_handler.active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (mesh::is_on_outline(cell->face(f)))
              add_tractions_on(cell, f, values);
      }

      void add_tractions_on(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                            const unsigned int                                            f,
                            dealii::FEFaceValues<dim>                                    &values)
      {
        for (unsigned int k = 0; k < scene.tractions.size(); ++k)
          {
            const auto &traction = scene.tractions[k];
            if (traction.where.body != number || !mesh.on_boundary(traction.where, cell->face(f)->boundary_id()))
              continue;
            if (is_constant(traction))
              {
                values.reinit(typename dealii::Triangulation<dim>::cell_iterator(cell), f);
                element.nodes_of(cell, dofs, nodes);
                add_traction(traction, values, sums[k]);
              }
            else
              add_formula(traction, surface_part(subdomain, spaces, cell, f), cell->face(f), k);
          }
      }

      static bool is_constant(const scene::Traction<dim> &traction)
      {
        return traction.pressure.is_constant() &&
               std::all_of(traction.components.begin(), traction.components.end(), [](const auto &component) {
                 return component.is_constant();
               });
      }

      /// Force per length of the local coordinate of an edge on each of its nodes.
      std::array<double, 6> forces_at(const scene::Traction<2> &traction,
                                      const SurfaceEdge<2>     &edge,
                                      const double              s) const
      {
        const auto       N = edge.shape(s), dN = edge.shape_derivative(s);
        dealii::Point<2> x;
        Vector           along;
        for (unsigned int i = 0; i < edge.n_nodes; ++i)
          {
            x += N[i] * Vector(edge.node(i));
            along += dN[i] * Vector(edge.node(i));
          }
        const double p     = traction.pressure.value(x, t); // against the normal (along_y, -along_x)
        const Vector force = weight(x) * (along.norm() * vector(traction.components, x));
        const double fx = force[0] - weight(x) * p * along[1], fy = force[1] + weight(x) * p * along[0];
        return {{N[0] * fx, N[0] * fy, N[1] * fx, N[1] * fy, N[2] * fx, N[2] * fy}};
      }

      using FacetForces = std::array<double, 3 * SurfaceFacet::max_nodes>;

      /// The same for a face, per area of its local coordinates.
      FacetForces forces_at(const scene::Traction<3>  &traction,
                            const SurfaceFacet        &facet,
                            const SurfaceFacet::Place &s) const
      {
        const auto   N     = facet.shape(s);
        const auto   x     = facet.point(s);
        const auto   area  = facet.area_vector(s);
        const Vector force = area.norm() * vector(traction.components, x) - traction.pressure.value(x, t) * area;
        FacetForces  forces{};
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            forces[dim * i + c] = N[i] * force[c];
        return forces;
      }

      void add_formula(const scene::Traction<2> &traction,
                       const SurfaceEdge<2>     &edge,
                       const Face               &face,
                       const unsigned int        k)
      {
        const AdaptiveQuadrature<6> forces([&](const double s) { return forces_at(traction, edge, s); });
        add_to_nodes(edge, forces.integral, face, sums[k]);
        if (!forces.is_resolved && !sums[k].unresolved)
          sums[k].unresolved = in_space(edge.point(0.5));
      }

      void add_formula(const scene::Traction<3> &traction,
                       const SurfaceFacet       &facet,
                       const Face               &face,
                       const unsigned int        k)
      {
        const AdaptiveCubature<3 * SurfaceFacet::max_nodes> forces(
          facet.n_corners(),
          [&](const std::array<double, 2> &s) { return forces_at(traction, facet, SurfaceFacet::Place(s[0], s[1])); });
        add_to_nodes(facet, forces.integral, face, sums[k]);
        differences_of_tractions[k].add(forces.scale, forces.difference, in_space(facet.middle()));
      }

      template <class Part, class Forces>
      void add_to_nodes(const Part &part, const Forces &forces, const Face &face, LoadResultant &sum)
      {
        spaces.for_each_face_node(subdomain,
                                  face,
                                  [&](const unsigned int node, const NodeKey &key, const dealii::Point<dim> &x) {
                                    unsigned int i = 0;
                                    while (part.keys[i] != key)
                                      ++i;
                                    Vector force;
                                    for (unsigned int c = 0; c < dim; ++c)
                                      force[c] = forces[dim * i + c];
                                    add(node, force);
                                    sum.sum.template add<dim>(force, x);
                                  });
      }

      void add_traction(const scene::Traction<dim>      &traction,
                        const dealii::FEFaceValues<dim> &values,
                        LoadResultant                   &sum)
      {
        for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
          {
            const auto  &x = values.quadrature_point(q);
            const Vector force =
              (vector(traction.components, x) - traction.pressure.value(x, t) * values.normal_vector(q)) *
              values.JxW(q) * weight(x);
            sum.sum.template add<dim>(force, x);
            for (unsigned int i = 0; i < nodes.size(); ++i)
              add(nodes[i], force * values.shape_value(i, q));
          }
      }

      const scene::Scene<dim>                     &scene;
      const mesh::Mesh<dim>                       &mesh;
      const mesh::SubdomainMesh<dim>              &subdomain;
      const Spaces<dim>                           &spaces;
      const Element<dim>                          &element;
      std::vector<LoadResultant>                   sums;
      std::vector<QuadratureDifference>            differences_of_tractions; // in space
      const dealii::DoFHandler<dim>               &dof_handler;
      unsigned int                                 number;
      const scene::Body<dim>                      &body;
      mesh::Kinematics<dim>                        kinematics;
      double                                       t;
      VolumeLoad<dim>                              volume;
      Eigen::VectorXd                              load;
      std::vector<dealii::types::global_dof_index> dofs; // of the current cell
      std::vector<unsigned int>                    nodes;
    };

    /// Calls f(number of the load, its node).
    template <int dim, class F>
    void for_each_point_load(const scene::Scene<dim> &scene,
                             const mesh::Mesh<dim>   &mesh,
                             const Spaces<dim>       &spaces,
                             const F                 &f)
    {
      if (scene.point_loads.empty())
        return;
      std::vector<scene::PointName<dim>> points;
      std::vector<std::string>           owners;
      for (const auto &load : scene.point_loads)
        {
          points.push_back(load.where);
          owners.push_back("Point load " + load.name);
        }
      const auto found = nodes_at(scene, mesh, spaces, points, owners);
      collectively(mesh.comm, [&] {
        for (unsigned int k = 0; k < found.size(); ++k)
          f(k, found[k]);
      });
    }

    /// Sums over the ranks; the place where a formula is not resolved is taken from the first rank that has one.
    std::vector<LoadResultant> over_all_ranks(const std::vector<LoadResultant> &own, const MPI_Comm comm)
    {
      std::vector<double> numbers;
      for (const auto &load : own)
        {
          const auto sum   = load.sum.numbers();
          const auto place = load.unresolved.value_or(std::array<double, 3>());
          numbers.insert(numbers.end(), sum.begin(), sum.end());
          numbers.push_back(load.unresolved ? 1. : 0.);
          numbers.insert(numbers.end(), place.begin(), place.end());
        }
      std::vector<LoadResultant> all(own.size());
      for (const auto &of_rank : all_gather(comm, numbers))
        for (unsigned int k = 0; k < all.size(); ++k)
          {
            const double *n = of_rank.data() + (Resultant::n_numbers + 4) * k;
            all[k].sum += Resultant::of(n);
            n += Resultant::n_numbers;
            if (n[0] > 0 && !all[k].unresolved)
              all[k].unresolved = std::array<double, 3>{{n[1], n[2], n[3]}};
          }
      return all;
    }

    /// Resultants of tractions, then of body forces, over all ranks. (A separate function, since a lambda that captures
    /// a type of this namespace would cause a compiler warning in a public function.)
    template <int dim>
    std::vector<LoadResultant> spread_resultants(const scene::Scene<dim> &scene,
                                                 const mesh::Mesh<dim>   &mesh,
                                                 const Spaces<dim>       &spaces,
                                                 const double             t)
    {
      const unsigned int                n_spread = scene.tractions.size() + scene.body_forces.size();
      std::vector<LoadResultant>        sums(n_spread);
      std::vector<QuadratureDifference> differences(n_spread);
      collectively(mesh.comm, [&] {
        for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
          {
            SubdomainLoad<dim> load(scene, mesh, spaces, p, t);
            const auto         own_differences = load.differences();
            for (unsigned int k = 0; k < n_spread; ++k)
              {
                differences[k].add(own_differences[k]);
                const auto &own = load.resultants()[k];
                sums[k].sum += own.sum;
                if (!sums[k].unresolved)
                  sums[k].unresolved = own.unresolved;
              }
          }
      });
      for (unsigned int k = 0; k < differences.size(); ++k)
        {
          const double size       = dealii::Utilities::MPI::sum(differences[k].size, mesh.comm);
          const double difference = dealii::Utilities::MPI::sum(differences[k].difference, mesh.comm);
          const double largest    = dealii::Utilities::MPI::max(differences[k].largest, mesh.comm);
          if (difference > allowed_difference * size && differences[k].largest == largest)
            sums[k].unresolved = differences[k].at;
        }
      return over_all_ranks(sums, mesh.comm);
    }
  } // namespace

  template <int dim>
  std::vector<Eigen::VectorXd> assemble_loads(const scene::Scene<dim> &scene,
                                              const mesh::Mesh<dim>   &mesh,
                                              const Spaces<dim>       &spaces,
                                              const double             t)
  {
    std::vector<Eigen::VectorXd> loads;
    collectively(mesh.comm, [&] { // a formula may fail on one rank only
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        loads.push_back(SubdomainLoad<dim>(scene, mesh, spaces, p, t).take());
    });
    for_each_point_load(scene, mesh, spaces, [&](const unsigned int k, const PointNode<dim> &at) {
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        if (mesh.subdomains[p]->subdomain == at.subdomain)
          for (unsigned int c = 0; c < dim; ++c)
            loads[p][dim * at.node + c] += scene.point_loads[k].force[c].value(at.position, t);
    });
    return loads;
  }

  template <int dim>
  std::vector<LoadResultant> load_resultants(const scene::Scene<dim> &scene,
                                             const mesh::Mesh<dim>   &mesh,
                                             const Spaces<dim>       &spaces,
                                             const double             t)
  {
    auto sums = spread_resultants(scene, mesh, spaces, t);
    for_each_point_load(scene, mesh, spaces, [&](const unsigned int k, const PointNode<dim> &at) {
      const auto &force = scene.point_loads[k].force;
      sums.emplace_back();
      dealii::Tensor<1, dim> at_point;
      for (unsigned int c = 0; c < dim; ++c)
        at_point[c] = force[c].value(at.position, t);
      sums.back().sum.template add<dim>(at_point, at.position);
    });
    return sums;
  }

  template std::vector<LoadResultant> load_resultants(const scene::Scene<2> &,
                                                      const mesh::Mesh<2> &,
                                                      const Spaces<2> &,
                                                      const double);

  template std::vector<LoadResultant> load_resultants(const scene::Scene<3> &,
                                                      const mesh::Mesh<3> &,
                                                      const Spaces<3> &,
                                                      const double);

  template std::vector<Eigen::VectorXd> assemble_loads(const scene::Scene<2> &,
                                                       const mesh::Mesh<2> &,
                                                       const Spaces<2> &,
                                                       const double);

  template std::vector<Eigen::VectorXd> assemble_loads(const scene::Scene<3> &,
                                                       const mesh::Mesh<3> &,
                                                       const Spaces<3> &,
                                                       const double);
} // namespace slipstick::mechanics
