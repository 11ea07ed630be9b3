// Places at which checks take their largest values.
#pragma once

#include <slipstick/tfeti/diagnosis.h>

#include <array>
#include <cmath>

namespace slipstick::contact
{
  /// Where a check is at its largest.
  struct Place
  {
    bool                  is_known = false;
    unsigned int          body     = 0;
    std::array<double, 3> position{{0, 0, 0}}; // reference configuration [mm]
    bool                  is_point = false;    // otherwise the place is a whole body
    bool                  in_pair  = false;    // whether a contact pair is given
    unsigned int          pair     = 0;        // index into Scene::contacts
  };

  /// The largest of some numbers (0 if there are none; a NaN is kept) and its place.
  struct Largest
  {
    double value = 0;
    Place  place;

    /// @return whether @p other is the largest so far.
    bool take(const double other, const Place &where)
    {
      if (std::isnan(value) || !(std::isnan(other) || other > value))
        return false;
      value = other;
      place = where;
      return true;
    }

    /// Takes the maximum over the ranks, with the place given by the first rank that has it. Collective.
    void over_all_ranks(const MPI_Comm comm);
  };

  /// Sets the maximum over all ranks of the violations of owned rows, and its place: a node that the row touches, found
  /// on the rank of its subdomain. Collective.
  void find_place_of_row(const tfeti::DualProblem &dual, const unsigned int owned_row, Largest &violation);

  /// Finds where a body has most of the energy of its jumps, and the contact pair there. Collective.
  void find_place_in_body(const tfeti::DualProblem  &dual,
                          const tfeti::JumpEnergies &energies,
                          const unsigned int         body,
                          Largest                   &error);
} // namespace slipstick::contact
