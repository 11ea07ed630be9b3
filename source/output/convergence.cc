#include <slipstick/output/convergence.h>
#include <slipstick/output/csv.h>

#include <ostream>

namespace slipstick::output
{
  void write_convergence(const OutputDirectory &directory, const std::vector<ConvergenceRow> &rows)
  {
    directory.write_from_root("convergence.csv", [&](std::ostream &out) {
      out << "step,algorithm,friction_step,outer_step,hessian_multiplications,projected_gradient,equality,"
             "at_lower_bound,at_upper_bound,free\n";
      for (const ConvergenceRow &row : rows)
        out << row.step << ',' << csv_field(row.algorithm) << ',' << row.friction_step << ',' << row.outer_step << ','
            << row.hessian_multiplications << ',' << to_text(row.projected_gradient) << ',' << to_text(row.equality)
            << ',' << row.at_lower_bound << ',' << row.at_upper_bound << ',' << row.free << '\n';
    });
  }
} // namespace slipstick::output
