#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/boundary_part.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>
#include <cmath>

namespace slipstick::scene
{
  namespace
  {
    const std::string acts_on = "Slip bound acts on";

    /// Reads a formula; if it is a number, it must not be negative.
    template <int dim>
    std::optional<LawNumber<dim>> read_number(const LawParameter &parameter,
                                              const std::string  &text,
                                              const std::string  &path,
                                              const Parameters   &parameters)
    {
      if (text == parameter.default_text) // e.g. "none"
        return {};
      const Field<dim> field(text, parameters.locate(path));
      if (field.is_constant() && field.value(dealii::Point<dim>(), 1) < 0)
        throw parameters.error(path,
                               "is negative",
                               "give a number >= 0" + (parameter.unit == "-" ? "" : " [" + parameter.unit + "]"));
      return LawNumber<dim>{parameter.name, parameter.unit, field};
    }
  } // namespace

  template <int dim>
  void ContactLawSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    std::vector<std::string>  names, meanings, acting_when_open;
    std::vector<LawParameter> parameters; // of all laws, with their meaning in each law
    for (const auto &kind : law_kinds<dim>())
      {
        names.push_back(kind.name);
        meanings.push_back(kind.name + (kind.meaning.empty() ? "" : " (" + kind.meaning + ")"));
        if (kind.can_act_when_open)
          acting_when_open.push_back(kind.name);
        for (const LawParameter &parameter : kind.parameters)
          {
            const auto found = std::find_if(parameters.begin(), parameters.end(), [&](const auto &other) {
              return other.name == parameter.name;
            });
            if (found == parameters.end())
              parameters.push_back(parameter);
            else
              found->meaning += "; " + parameter.meaning;
          }
      }
    add_word(prm, "Law", law, names, join_names(meanings), [this](const std::string &word) { law = word; });
    for (const LawParameter &parameter : parameters)
      {
        std::string &text = numbers[parameter.name];
        text              = parameter.default_text.empty() ? "0" : parameter.default_text;
        add_text(prm,
                 parameter.name,
                 text,
                 parameter.unit,
                 (parameter.default_text.empty() ? "" : parameter.default_text + ", or ") + field_format<dim>() +
                   ", >= 0",
                 parameter.meaning);
      }
    add_choice(prm,
               acts_on,
               only_closed,
               Choices<bool>{{"boundary", false}, {"contact", true}},
               join_names(acting_when_open) +
                 ": on the whole slave boundary, open nodes included, or where it is in contact");
    add_text(prm,
             "Offset",
             offset,
             "mm",
             field_format<dim>(),
             "added to the gap; negative: interference of a press fit");
  }

  template <int dim>
  void ContactLawSection<dim>::read(const Parameters  &parameters,
                                    const std::string &section,
                                    ContactPair<dim>  &pair) const
  {
    for (const auto &kind : law_kinds<dim>())
      {
        std::vector<std::optional<LawNumber<dim>>> values;
        for (const LawParameter &parameter : kind.parameters)
          {
            const std::string path = section + "/" + parameter.name;
            if (kind.name == law && !parameter.remedy.empty())
              parameters.require(path, parameter.remedy);
            values.push_back(read_number<dim>(parameter, numbers.at(parameter.name), path, parameters));
          }
        if (kind.name == law)
          pair.law = kind.law(values);
      }
    pair.law.acts_when_open = pair.law.acts_when_open && !only_closed;
    pair.offset             = Field<dim>(offset, parameters.locate(section + "/Offset"));
  }

  template <int dim>
  std::vector<std::string> ContactLawSection<dim>::without_effect(const Parameters  &parameters,
                                                                  const std::string &section) const
  {
    std::map<std::string, std::vector<std::string>> laws; // by parameter
    std::map<std::string, std::string>              harmless{{acts_on, "boundary"}};
    for (const auto &kind : law_kinds<dim>())
      {
        if (kind.can_act_when_open)
          laws[acts_on].push_back(kind.name);
        for (const LawParameter &parameter : kind.parameters)
          {
            laws[parameter.name].push_back(kind.name);
            harmless[parameter.name] = parameter.default_text.empty() ? "0" : parameter.default_text;
          }
      }
    std::vector<std::string> warnings;
    for (const auto &[parameter, of_laws] : laws)
      {
        const std::string path  = section + "/" + parameter;
        const auto        value = parameters.value(path);
        if (!value || std::count(of_laws.begin(), of_laws.end(), law) > 0 || parameters.is_override(section + "/Law"))
          continue;
        // the default is harmless: a .prm printed by the program sets everything
        const auto number = parse_number(*value);
        if (trim(*value) == harmless.at(parameter) || (number && *number == 0))
          continue;
        warnings.push_back(parameters.locate(path) + " = '" + *value + "' has no effect with Law = " + law +
                           ", it belongs to " + join_names(of_laws) + "; leave it out, or set Law as well");
      }
    return warnings;
  }

  template <int dim>
  ContactSection<dim>::ContactSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void ContactSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Contact " + name);
    add_text(
      prm,
      "Slave",
      slave,
      "",
      boundary_format,
      "boundary that may come into contact with the master; the finer or softer side of two bodies; must be set");
    add_text(prm,
             "Master",
             master,
             "",
             "BODY/BOUNDARY, or a name from Obstacles",
             "boundary of a body or rigid obstacle that it may touch; must be set");
    law.declare(prm);
    add_text(prm,
             "Gap",
             gap,
             "mm",
             "geometry, " + field_format<dim>(),
             "initial distance along the normal: that of the geometry, or a given one instead");
    add_text(prm,
             "Reach",
             reach,
             "mm",
             "auto, or a number > 0",
             "nodes farther apart along the normal are not paired; auto: two bodies from distance and mesh, obstacles "
             "without limit");
    add_choice(prm,
               "Discretization",
               discretization,
               Choices<ContactDiscretization>{{"auto", ContactDiscretization::automatic},
                                              {"node to node", ContactDiscretization::node_to_node},
                                              {"mortar", ContactDiscretization::mortar}},
               "two bodies: auto is node to node where every slave node has a master node opposite, otherwise mortar");
    prm.leave_subsection();
  }

  template <int dim>
  void ContactSection<dim>::read_master(const Parameters &parameters,
                                        const Scene<dim> &scene,
                                        ContactPair<dim> &pair) const
  {
    const std::string        path = "Contact " + name + "/Master";
    std::vector<std::string> obstacles;
    for (const Obstacle<dim> &obstacle : scene.obstacles)
      obstacles.push_back(obstacle.name);
    parameters.require(path, "set BODY/BOUNDARY, or a name from Obstacles (" + join_names(obstacles) + ")");
    if (master.find('/') == std::string::npos)
      {
        pair.obstacle = std::find(obstacles.begin(), obstacles.end(), master) - obstacles.begin();
        if (pair.obstacle == obstacles.size())
          throw parameters.error(path, "unknown obstacle", suggest_name(master, obstacles));
        return;
      }
    pair.master = read_boundary(master, path, parameters, scene.bodies);
    if (pair.master->body == pair.slave.body &&
        (pair.master->boundary == pair.slave.boundary || pair.master->boundary == "*" || pair.slave.boundary == "*"))
      throw parameters.error(path,
                             "is part of the slave boundary: a boundary cannot be in contact with itself",
                             "choose two different boundaries of body '" + scene.bodies[pair.slave.body].name + "'");
  }

  template <int dim>
  ContactPair<dim> ContactSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Contact " + name;
    ContactPair<dim>  pair;
    pair.name           = name;
    pair.discretization = discretization;
    pair.slave          = read_boundary(slave, section + "/Slave", parameters, scene.bodies);
    read_master(parameters, scene, pair);
    law.read(parameters, section, pair);
    if (gap != "geometry")
      pair.gap = Field<dim>(gap, parameters.locate(section + "/Gap"));
    if (reach != "auto")
      {
        const Field<dim> number(reach, parameters.locate(section + "/Reach"));
        if (!number.is_constant() || !(number.value(dealii::Point<dim>(), 1) > 0))
          throw parameters.error(section + "/Reach", "is not a number > 0", "give a length in mm, or auto");
        pair.reach = number.value(dealii::Point<dim>(), 1);
      }
    return pair;
  }

  template <int dim>
  void ContactSearchSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Contact search");
    add_choice(
      prm,
      "Mode",
      automatic,
      Choices<bool>{{"declared", false}, {"automatic", true}},
      "automatic also pairs all bodies whose outlines face each other within Reach and that no pair of Contacts "
      "joins");
    add_number(prm,
               "Reach",
               reach,
               "mm",
               Interval::from(0),
               "automatic: outlines closer than this make a pair; 0: outlines that touch");
    law.declare(prm);
    prm.leave_subsection();
  }

  template <int dim>
  ContactSearch<dim> ContactSearchSection<dim>::read(const Parameters &parameters) const
  {
    ContactSearch<dim> search;
    search.automatic = automatic;
    if (reach > 0 && !parameters.is_set("Contact search/Mode"))
      throw parameters.error("Contact search/Reach",
                             "has no effect without a search",
                             "set Contact search/Mode = automatic, or leave it out");
    search.reach = reach;
    law.read(parameters, "Contact search", search.pair);
    return search;
  }

  template struct ContactLawSection<2>;
  template struct ContactSection<2>;
  template struct ContactSearchSection<2>;
  template struct ContactLawSection<3>;
  template struct ContactSection<3>;
  template struct ContactSearchSection<3>;
} // namespace slipstick::scene
