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

  void write_history(const OutputDirectory &directory, const std::vector<StepSummary> &steps, const unsigned int dim)
  {
    directory.write_from_root("history.csv", [&](std::ostream &out) {
      out << "step,t";
      if (!steps.empty())
        for (const auto &one : all_of(steps.front()))
          for (const std::string &column : dim == 2
                                             ? std::vector<std::string>{" Fx", " Fy", " moment"}
                                             : std::vector<std::string>{" Fx", " Fy", " Fz", " Mx", " My", " Mz"})
            out << ',' << csv_field(one.kind + " " + one.name + column);
      if (!steps.empty())
        for (const auto &bolt : steps.front().pretensions)
          out << ',' << csv_field("pretension " + bolt.name + " force") << ','
              << csv_field("pretension " + bolt.name + " shortening");
      if (!steps.empty())
        for (const auto &probe : steps.front().probes)
          if (probe.is_point)
            for (unsigned int d = 0; d < dim; ++d)
              out << ',' << csv_field("probe " + probe.name + " u" + "xyz"[d]);
      out << '\n';
      for (unsigned int k = 0; k < steps.size(); ++k)
        {
          out << k << ',' << to_text(steps[k].load_factor);
          for (const auto &one : all_of(steps[k]))
            {
              for (unsigned int d = 0; d < dim; ++d)
                out << ',' << to_text(one.sum.force[d]);
              for (unsigned int d = dim == 2 ? 2 : 0; d < 3; ++d)
                out << ',' << to_text(one.sum.moment[d]);
            }
          for (const auto &bolt : steps[k].pretensions)
            out << ',' << to_text(bolt.force) << ',' << to_text(bolt.shortening);
          for (const auto &probe : steps[k].probes)
            if (probe.is_point)
              for (unsigned int d = 0; d < dim; ++d)
                out << ',' << to_text(probe.points.front().displacement[d]);
          out << '\n';
        }
    });
  }
} // namespace slipstick::output
