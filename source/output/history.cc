#include <slipstick/output/csv.h>
#include <slipstick/output/history.h>

#include <ostream>

namespace slipstick::output
{
  namespace
  {
    std::vector<NamedResultant> all_of(const StepSummary &step)
    {
      std::vector<NamedResultant> all;
      for (const auto *list : {&step.forces.loads, &step.forces.supports, &step.forces.foundations})
        all.insert(all.end(), list->begin(), list->end());
      for (const auto &pair : step.contact)
        all.push_back({pair.pair, "contact", pair.on_slave});
      return all;
    }
  } // namespace

  void write_history(const OutputDirectory &directory, const std::vector<StepSummary> &steps)
  {
    directory.write_from_root("history.csv", [&](std::ostream &out) {
      out << "step,t";
      if (!steps.empty())
        for (const auto &one : all_of(steps.front()))
          for (const std::string column : {" Fx", " Fy", " moment"})
            out << ',' << csv_field(one.kind + " " + one.name + column);
      if (!steps.empty())
        for (const auto &probe : steps.front().probes)
          if (probe.is_point)
            for (const std::string column : {" ux", " uy"})
              out << ',' << csv_field("probe " + probe.name + column);
      out << '\n';
      for (unsigned int k = 0; k < steps.size(); ++k)
        {
          out << k << ',' << to_text(steps[k].load_factor);
          for (const auto &one : all_of(steps[k]))
            out << ',' << to_text(one.sum.force[0]) << ',' << to_text(one.sum.force[1]) << ','
                << to_text(one.sum.moment);
          for (const auto &probe : steps[k].probes)
            if (probe.is_point)
              for (const double component : probe.points.front().displacement)
                out << ',' << to_text(component);
          out << '\n';
        }
    });
  }
} // namespace slipstick::output
