#include <slipstick/base/gather.h>
#include <slipstick/contact/places.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <optional>

namespace slipstick::contact
{
  namespace
  {
    using tfeti::DistributedVector;

    /// The contact pair of a row where x (owned rows) is not 0, the same on all ranks; nothing if there is none.
    /// Collective.
    std::optional<unsigned int> pair_of(const tfeti::DualProblem &dual, const DistributedVector &x)
    {
      unsigned int pair = 0; // its number + 1, 0 for none
      for (const auto &point : dual.constraints().contact_points)
        for (const unsigned int row : {point.normal_row, point.tangential_row, point.second_row})
          if (row != tfeti::invalid_row && x.local_element(row) != 0)
            pair = point.pair + 1;
      pair = dealii::Utilities::MPI::max(pair, dual.communicator());
      return pair > 0 ? std::make_optional(pair - 1) : std::nullopt;
    }

    Place place_of(const tfeti::SubdomainSystem     &subdomain,
                   const unsigned int                unknown,
                   const std::optional<unsigned int> pair)
    {
      return {true, subdomain.body(), subdomain.position(unknown), true, pair.has_value(), pair.value_or(0)};
    }

    /// Whether this is the first rank where @p says_so is true. Collective.
    bool is_first(const bool says_so, const MPI_Comm comm)
    {
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
      return rank == dealii::Utilities::MPI::min(says_so ? rank : dealii::Utilities::MPI::n_mpi_processes(comm), comm);
    }
  } // namespace

  void Largest::over_all_ranks(const MPI_Comm comm)
  {
    const std::vector<double> own{value,
                                  static_cast<double>(place.is_known),
                                  static_cast<double>(place.body),
                                  place.position[0],
                                  place.position[1],
                                  place.position[2],
                                  static_cast<double>(place.is_point),
                                  static_cast<double>(place.in_pair),
                                  static_cast<double>(place.pair)};
    Largest                   all;
    for (const auto &n : all_gather(comm, own))
      {
        const Place where = {n[1] > 0,
                             static_cast<unsigned int>(n[2]),
                             {{n[3], n[4], n[5]}},
                             n[6] > 0,
                             n[7] > 0,
                             static_cast<unsigned int>(n[8])};
        if (!all.take(n[0], where) && n[0] == all.value && !all.place.is_known)
          all.place = where; // an earlier rank had the same value without a place
      }
    *this = all;
  }

  void find_place_of_row(const tfeti::DualProblem &dual, const unsigned int owned_row, Largest &violation)
  {
    const MPI_Comm           comm    = dual.communicator();
    const double             largest = dealii::Utilities::MPI::max(violation.value, comm);
    tfeti::DistributedVector one     = dual.zero();
    if (is_first(owned_row != tfeti::invalid_row && violation.value == largest, comm))
      one.local_element(owned_row) = 1;
    const auto pair    = pair_of(dual, one);
    const auto touched = dual.dual_operator().forces(one);
    for (unsigned int p = 0; p < touched.size(); ++p)
      {
        Eigen::Index unknown;
        if (touched[p].size() > 0 && touched[p].cwiseAbs().maxCoeff(&unknown) > 0)
          violation.place = place_of(*dual.subdomains()[p], unknown, pair);
      }
    if (!std::isnan(violation.value))
      violation.value = largest;
  }

  void find_place_in_body(const tfeti::DualProblem  &dual,
                          const tfeti::JumpEnergies &energies,
                          const unsigned int         body,
                          Largest                   &error)
  {
    const MPI_Comm comm  = dual.communicator();
    const auto    &spot  = energies.spots[body];
    const double   most  = dealii::Utilities::MPI::max(spot.energy, comm);
    const bool     is_it = is_first(spot.energy >= 0 && spot.energy == most, comm);
    const auto     pair =
      pair_of(dual, dual.dual_operator().column(is_it ? spot.subdomain : dual.subdomains().size(), spot.touched));
    if (is_it)
      {
        const auto &subdomain = *dual.subdomains()[spot.subdomain];
        error.place           = place_of(subdomain, subdomain.touched()[spot.touched], pair);
      }
  }
} // namespace slipstick::contact
