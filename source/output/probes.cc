#include <slipstick/output/csv.h>
#include <slipstick/output/probes.h>

#include <ostream>

namespace slipstick::output
{
  void write_probes(const OutputDirectory &directory, const std::vector<StepSummary> &steps, const unsigned int dim)
  {
    if (steps.empty() || steps.front().probes.empty())
      return;
    directory.write_from_root("probes.csv", [&](std::ostream &out) {
      out
        << (dim == 2
              ? "step,t,probe,s,x,y,u_x,u_y,stress_xx,stress_yy,stress_xy,stress_zz,von_mises\n"
              : "step,t,probe,s,x,y,z,u_x,u_y,u_z,stress_xx,stress_yy,stress_xy,stress_zz,stress_xz,stress_yz,von_mises\n");
      for (unsigned int k = 0; k < steps.size(); ++k)
        for (const auto &probe : steps[k].probes)
          for (const auto &point : probe.points)
            {
              out << k << ',' << to_text(steps[k].load_factor) << ',' << csv_field(probe.name);
              out << ',' << to_text(point.distance);
              for (unsigned int d = 0; d < dim; ++d)
                out << ',' << to_text(point.position[d]);
              for (unsigned int d = 0; d < dim; ++d)
                out << ',' << to_text(point.displacement[d]);
              for (unsigned int c = 0; c < 2 * dim; ++c)
                out << ',' << to_text(point.stress[c]);
              out << ',' << to_text(point.von_mises) << '\n';
            }
    });
  }
} // namespace slipstick::output
