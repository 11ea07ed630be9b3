#include <slipstick/contact/resultants.h>

#include <deal.II/base/mpi.h>

#include <set>

namespace slipstick::contact
{
  std::vector<Resultant> reactions(const tfeti::DualProblem                 &dual,
                                   const tfeti::HeldContacts                &held,
                                   const std::vector<std::array<double, 3>> &held_forces,
                                   const tfeti::DistributedVector           &multipliers,
                                   const unsigned int                        n_holders)
  {
    std::vector<Resultant> own(n_holders);
    const auto             add = [&](const unsigned int holder, const std::array<double, 3> &force, const auto &at) {
      if (holder < n_holders) // otherwise a bond to an obstacle, whose nodes are counted with the pairs
        own[holder].add<3>(force, at);
    };
    for (const auto &reaction : dual.constraints().reactions)
      {
        const double part = -multipliers.local_element(reaction.row) / reaction.holders.size();
        for (const unsigned int h : reaction.holders)
          add(h,
              {{part * reaction.direction[0], part * reaction.direction[1], part * reaction.direction[2]}},
              reaction.position);
      }
    for (unsigned int i = 0; i < held.points.size(); ++i)
      if (const auto &point = held.points[i]; !point.is_bonded)
        {
          std::set<unsigned int> holders;
          for (const unsigned int r : point.reactions)
            holders.insert(dual.constraints().reactions[r].holders.begin(),
                           dual.constraints().reactions[r].holders.end());
          for (const unsigned int h : holders)
            add(h,
                {{-held_forces[i][0] / holders.size(),
                  -held_forces[i][1] / holders.size(),
                  -held_forces[i][2] / holders.size()}},
                point.contact.slave_position);
        }
    std::vector<double> numbers;
    for (const auto &resultant : own)
      {
        const auto some = resultant.numbers();
        numbers.insert(numbers.end(), some.begin(), some.end());
      }
    if (!numbers.empty())
      MPI_Allreduce(MPI_IN_PLACE, numbers.data(), numbers.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
    for (unsigned int h = 0; h < n_holders; ++h)
      own[h] = Resultant::of(numbers.data() + Resultant::n_numbers * h);
    return own;
  }
} // namespace slipstick::contact
