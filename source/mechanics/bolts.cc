#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/mechanics/bolts.h>

#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    // Nodes within this fraction of the bolt's length from the section count as below it, on all subdomains.
    constexpr double on_section = 1e-9;

    template <int dim>
    double height(const scene::Pretension<dim> &bolt, const Eigen::MatrixXd &positions, const Eigen::Index node)
    {
      double sum = 0;
      for (unsigned int c = 0; c < dim; ++c)
        sum += bolt.direction[c] * (positions(c, node) - bolt.point[c]);
      return sum;
    }
  } // namespace

  template <int dim>
  Bolts<dim>::Bolts(const scene::Scene<dim>                     &scene,
                    const std::vector<tfeti::SubdomainMatrices> &matrices,
                    const MPI_Comm                               comm_)
    : comm(comm_)
  {
    for (const auto &given : scene.pretensions)
      {
        Bolt bolt;
        bolt.body      = given.body;
        double ends[2] = {-std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()}; // below, above
        for (const auto &part : matrices)
          for (Eigen::Index i = 0; part.body == bolt.body && i < part.positions.cols(); ++i)
            {
              const double z = height(given, part.positions, i);
              ends[0]        = std::max(ends[0], -z);
              ends[1]        = std::max(ends[1], z);
            }
        MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_DOUBLE, MPI_MAX, comm);
        bolt.length = ends[0] + ends[1];
        if (!(std::min(ends[0], ends[1]) > on_section * bolt.length))
          throw InputError(
            format("Pretension %s/Point: the section does not cut body '%s', which reaches from %.6g to %.6g mm "
                   "along Direction, measured from Point",
                   given.name.c_str(),
                   scene.bodies[bolt.body].name.c_str(),
                   -ends[0],
                   ends[1]),
            "choose a point between the two ends of the bolt");
        for (unsigned int p = 0; p < matrices.size(); ++p)
          {
            if (matrices[p].body != bolt.body)
              continue;
            const auto           &positions = matrices[p].positions;
            const Eigen::VectorXd zero      = Eigen::VectorXd::Zero(matrices[p].load.size());
            Part                  part{p, zero, zero};
            Eigen::VectorXd       even = zero;
            for (Eigen::Index i = 0; i < positions.cols(); ++i)
              for (unsigned int c = 0; c < dim; ++c)
                {
                  const double z    = height(given, positions, i);
                  even[dim * i + c] = given.direction[c] * z / bolt.length;
                  if (z > on_section * bolt.length)
                    part.h[dim * i + c] = given.direction[c];
                }
            const auto K                   = matrices[p].stiffness.template selfadjointView<Eigen::Lower>();
            part.Kh                        = K * part.h;
            const Eigen::VectorXd strained = K * even;
            bolt.stiffness += even.dot(strained);
            bolt.parts.push_back(std::move(part));
          }
        bolt.stiffness = dealii::Utilities::MPI::sum(bolt.stiffness, comm);
        bolts.push_back(std::move(bolt));
      }
  }

  template <int dim>
  std::vector<double> Bolts<dim>::stiffnesses() const
  {
    std::vector<double> result;
    for (const Bolt &bolt : bolts)
      result.push_back(bolt.stiffness);
    return result;
  }

  template <int dim>
  std::vector<double> Bolts<dim>::lengths() const
  {
    std::vector<double> result;
    for (const Bolt &bolt : bolts)
      result.push_back(bolt.length);
    return result;
  }

  template <int dim>
  void Bolts<dim>::add_loads(const std::vector<double> &shortening, std::vector<Eigen::VectorXd> &loads) const
  {
    for (std::size_t k = 0; k < bolts.size(); ++k)
      for (const Part &part : bolts[k].parts)
        loads[part.p] -= shortening[k] * part.Kh;
  }

  template <int dim>
  std::vector<Eigen::VectorXd> Bolts<dim>::elastic_part(std::vector<Eigen::VectorXd> u,
                                                        const std::vector<double>   &shortening) const
  {
    for (std::size_t k = 0; k < bolts.size(); ++k)
      for (const Part &part : bolts[k].parts)
        u[part.p] += shortening[k] * part.h;
    return u;
  }

  template <int dim>
  std::vector<double> Bolts<dim>::tensions(const std::vector<Eigen::VectorXd> &u,
                                           const std::vector<double>          &shortening,
                                           const std::vector<Eigen::VectorXd> &thermal) const
  {
    const auto          v = elastic_part(u, shortening);
    std::vector<double> result(bolts.size(), 0.);
    for (std::size_t k = 0; k < bolts.size(); ++k)
      for (const Part &part : bolts[k].parts)
        result[k] += part.Kh.dot(v[part.p]) - (thermal.empty() ? 0. : part.h.dot(thermal[part.p]));
    MPI_Allreduce(MPI_IN_PLACE, result.data(), result.size(), MPI_DOUBLE, MPI_SUM, comm);
    return result;
  }

  template <int dim>
  std::vector<double> Bolts<dim>::initial_strain_energies(const std::vector<Eigen::VectorXd> &u,
                                                          const std::vector<double>          &shortening,
                                                          const unsigned int                  n_bodies) const
  {
    // v'K v - u'K u = s h'K (v + u), summed over the bolts, as K is symmetric
    std::vector<double> result(n_bodies, 0.);
    const auto          v = elastic_part(u, shortening);
    for (std::size_t k = 0; k < bolts.size(); ++k)
      for (const Part &part : bolts[k].parts)
        result[bolts[k].body] += shortening[k] * part.Kh.dot(v[part.p] + u[part.p]);
    return result;
  }

  template class Bolts<2>;
  template class Bolts<3>;
} // namespace slipstick::mechanics
