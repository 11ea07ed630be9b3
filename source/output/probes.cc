#include <slipstick/output/csv.h>
#include <slipstick/output/probes.h>

#include <ostream>

namespace slipstick::output
{
  void write_probes(const OutputDirectory &directory, const std::vector<StepSummary> &steps)
  {
    if (steps.empty() || steps.front().probes.empty())
      return;
    directory.write_from_root("probes.csv", [&](std::ostream &out) {
      out << "step,t,probe,s,x,y,u_x,u_y,stress_xx,stress_yy,stress_xy,stress_zz,von_mises\n";
      for (unsigned int k = 0; k < steps.size(); ++k)
        for (const auto &probe : steps[k].probes)
          for (const auto &point : probe.points)
            {
              out << k << ',' << to_text(steps[k].load_factor) << ',' << csv_field(probe.name);
              for (const double value : {point.distance,
                                         point.position[0],
                                         point.position[1],
                                         point.displacement[0],
                                         point.displacement[1],
                                         point.stress[0],
                                         point.stress[1],
                                         point.stress[2],
                                         point.stress[3],
                                         point.von_mises})
                out << ',' << to_text(value);
              out << '\n';
            }
    });
  }
} // namespace slipstick::output
