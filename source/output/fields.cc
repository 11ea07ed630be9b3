#include <slipstick/base/collective.h>
#include <slipstick/base/log.h>
#include <slipstick/fem/elasticity.h>
#include <slipstick/output/fields.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/numerics/data_out.h>
#include <deal.II/numerics/data_postprocessor.h>

#include <cmath>

namespace slipstick::output
{
  namespace
  {
    /// What one node carries: displacement, stress xx yy xy zz.
    template <int dim>
    constexpr unsigned int n_nodal_values = dim + 4;

    /// From displacement and stress components to the fields that users look at.
    template <int dim>
    class Fields : public dealii::DataPostprocessor<dim>
    {
    public:
      std::vector<std::string> get_names() const override
      {
        std::vector<std::string> names(dim, "displacement");
        names.insert(names.end(), dim * dim, "stress");
        names.insert(names.end(), {"stress_zz", "von_mises", "principal_stress_1", "principal_stress_2"});
        return names;
      }

      std::vector<dealii::DataComponentInterpretation::DataComponentInterpretation> get_data_component_interpretation()
        const override
      {
        using namespace dealii::DataComponentInterpretation;
        std::vector<DataComponentInterpretation> kinds(dim, component_is_part_of_vector);
        kinds.insert(kinds.end(), dim * dim, component_is_part_of_tensor);
        kinds.insert(kinds.end(), 4, component_is_scalar);
        return kinds;
      }

      dealii::UpdateFlags get_needed_update_flags() const override
      {
        return dealii::update_values;
      }

      void evaluate_vector_field(const dealii::DataPostprocessorInputs::Vector<dim> &input,
                                 std::vector<dealii::Vector<double>>                &computed) const override
      {
        static_assert(dim == 2, "stress components of the plane");
        for (unsigned int q = 0; q < computed.size(); ++q)
          {
            const auto  &in  = input.solution_values[q];
            auto        &out = computed[q];
            const double xx = in[2], yy = in[3], xy = in[4], zz = in[5];
            const double mean = (xx + yy) / 2, radius = std::hypot((xx - yy) / 2, xy);
            unsigned int k = 0;
            for (const double value :
                 {in[0], in[1], xx, xy, xy, yy, zz, fem::von_mises(xx, yy, xy, zz), mean + radius, mean - radius})
              out[k++] = value;
          }
      }
    };

    std::string vtu_name(const unsigned int step, const unsigned int subdomain)
    {
      return format("subdomain_%03u_%04u.vtu", step, subdomain);
    }

    std::string pvtu_name(const unsigned int step)
    {
      return format("solution_%03u.pvtu", step);
    }

    template <int dim>
    dealii::Vector<double> constant(const fem::SubdomainMesh<dim> &subdomain, const double value)
    {
      dealii::Vector<double> cells(subdomain.triangulation.n_active_cells());
      cells = value;
      return cells;
    }

    /// Displacement and stress, node by node, in the numbering of a space with all components.
    template <int dim>
    dealii::Vector<double> nodal_values(const dealii::DoFHandler<dim> &all,
                                        const dealii::DoFHandler<dim> &displacements,
                                        const Eigen::VectorXd         &u,
                                        const Eigen::MatrixXd         &stress)
    {
      dealii::Vector<double>                       values(all.n_dofs());
      std::vector<dealii::types::global_dof_index> from(displacements.get_fe().n_dofs_per_cell()),
        to(all.get_fe().n_dofs_per_cell());
      const unsigned int n_nodes = from.size() / dim;
      for (const auto &cell : all.active_cell_iterators())
        {
          cell->get_dof_indices(to);
          typename dealii::DoFHandler<dim>::active_cell_iterator(&all.get_triangulation(),
                                                                 cell->level(),
                                                                 cell->index(),
                                                                 &displacements)
            ->get_dof_indices(from);
          for (unsigned int i = 0; i < n_nodes; ++i)
            {
              const unsigned int node = from[displacements.get_fe().component_to_system_index(0, i)] / dim;
              for (unsigned int c = 0; c < n_nodal_values<dim>; ++c)
                values[to[all.get_fe().component_to_system_index(c, i)]] =
                  c < dim ? u[dim * node + c] : stress(node, c - dim);
            }
        }
      return values;
    }

    /// One .vtu; the subdomain that comes first also writes the .pvtu, whose fields are the same.
    template <int dim>
    void write_subdomain(const OutputDirectory      &directory,
                         const fem::Mesh<dim>       &mesh,
                         const fem::Spaces<dim>     &spaces,
                         const unsigned int          p,
                         const Eigen::VectorXd      &u,
                         const fem::SubdomainStress &stress,
                         const unsigned int          step)
    {
      const auto                 &subdomain = *mesh.subdomains[p];
      const dealii::FESystem<dim> element(*spaces.of(p).scalar, n_nodal_values<dim>);
      dealii::DoFHandler<dim>     all(subdomain.triangulation);
      all.distribute_dofs(element);
      const auto                   values = nodal_values(all, *spaces.dof_handlers[p], u, stress.nodal);
      const Fields<dim>            fields;
      const dealii::Vector<double> error(stress.error.data(), stress.error.data() + stress.error.size());
      const auto body = constant(subdomain, subdomain.body), number = constant(subdomain, subdomain.subdomain),
                 owner = constant(subdomain, mesh.rank_of_subdomain(subdomain.subdomain));

      dealii::DataOut<dim> data_out;
      data_out.set_flags(dealii::DataOutBase::VtkFlags(std::numeric_limits<double>::min(),
                                                       std::numeric_limits<unsigned int>::min(),
                                                       false,
                                                       dealii::DataOutBase::VtkFlags::best_speed));
      data_out.attach_dof_handler(all);
      data_out.add_data_vector(values, fields);
      data_out.add_data_vector(body, "body", dealii::DataOut<dim>::type_cell_data);
      data_out.add_data_vector(number, "subdomain", dealii::DataOut<dim>::type_cell_data);
      data_out.add_data_vector(owner, "rank", dealii::DataOut<dim>::type_cell_data);
      data_out.add_data_vector(error, "error_estimate", dealii::DataOut<dim>::type_cell_data);
      data_out.build_patches(*spaces.of(p).mapping, spaces.degree);
      directory.write(vtu_name(step, subdomain.subdomain), [&](std::ostream &out) { data_out.write_vtu(out); });
      if (subdomain.subdomain == 0)
        directory.write(pvtu_name(step), [&](std::ostream &out) {
          std::vector<std::string> names;
          for (unsigned int s = 0; s < mesh.n_subdomains(); ++s)
            names.push_back(vtu_name(step, s));
          data_out.write_pvtu_record(out, names);
        });
    }
  } // namespace

  template <int dim>
  void write_fields(const OutputDirectory              &directory,
                    const fem::Mesh<dim>               &mesh,
                    const fem::Spaces<dim>             &spaces,
                    const std::vector<Eigen::VectorXd> &u,
                    const fem::StressResult            &stress,
                    const unsigned int                  step)
  {
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        write_subdomain(directory, mesh, spaces, p, u[p], stress.subdomains[p], step);
    });
  }

  void write_pvd(const OutputDirectory &directory, const std::vector<double> &load_factors)
  {
    directory.write_from_root("solution.pvd", [&](std::ostream &out) {
      std::vector<std::pair<double, std::string>> records;
      for (unsigned int step = 0; step < load_factors.size(); ++step)
        records.emplace_back(load_factors[step], pvtu_name(step));
      dealii::DataOutBase::write_pvd_record(out, records);
    });
  }

  template void write_fields(const OutputDirectory &,
                             const fem::Mesh<2> &,
                             const fem::Spaces<2> &,
                             const std::vector<Eigen::VectorXd> &,
                             const fem::StressResult &,
                             const unsigned int);
} // namespace slipstick::output
