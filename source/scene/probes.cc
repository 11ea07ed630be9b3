#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

namespace slipstick::scene
{
  namespace
  {
    template <int dim>
    std::string format()
    {
      return std::string("x, y, ") + (dim == 3 ? "z, " : "") + "or the name of a point in the mesh file";
    }

    // More points than can be distinguished in a plot of a line.
    constexpr unsigned int most_points = 100000;
  } // namespace

  template <int dim>
  ProbeSection<dim>::ProbeSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void ProbeSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Probe " + name);
    add_text(prm, "Body", body, "", "a name from Bodies", "body of the probe; must be set");
    add_text(prm, "Point", point, "mm", format<dim>(), "a point of it; this or From and To must be set");
    add_text(prm, "From", from, "mm", format<dim>(), "start of a straight line");
    add_text(prm, "To", to, "mm", format<dim>(), "its end");
    add_count(prm, "Number of points", n_points, 2, most_points, "points on the line, including its ends");
    prm.leave_subsection();
  }

  template <int dim>
  Probe<dim> ProbeSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Probe " + name;
    parameters.require(section + "/Body", "set the body of the probe");
    Probe<dim> probe;
    probe.name     = name;
    probe.n_points = n_points;
    probe.body     = read_body(body, section + "/Body", parameters, scene.bodies);
    const auto end = [&](const std::string &text, const std::string &which) {
      probe.ends.push_back(read_point(text, section + "/" + which, parameters, probe.body, scene.bodies[probe.body]));
    };
    const bool is_line = !from.empty() || !to.empty();
    if (is_line && !point.empty())
      throw parameters.error(section + "/Point",
                             "is given in addition to a line",
                             "set either Point, or From and To, and remove the other");
    if (is_line)
      {
        end(from, "From");
        end(to, "To");
      }
    else
      end(point, "Point");
    return probe;
  }

  template struct ProbeSection<2>;
  template struct ProbeSection<3>;
} // namespace slipstick::scene
