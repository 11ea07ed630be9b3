#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/contact_law.h>

#include <algorithm>
#include <stdexcept>

namespace slipstick::scene
{
  namespace
  {
    template <int dim>
    LawKind<dim> bonded_law()
    {
      return {"bonded", "no relative displacement, tension too; a gap stays as it is", {}, [](const auto &) {
                ContactLaw<dim> law;
                law.is_bonded = true;
                return law;
              }};
    }

    template <int dim>
    LawKind<dim> frictionless_law()
    {
      return {"frictionless", "", {}, [](const auto &) { return ContactLaw<dim>(); }};
    }

    template <int dim>
    LawKind<dim> tresca_law()
    {
      return {"Tresca",
              "friction with a given slip bound",
              {{"Slip bound",
                "MPa",
                "Tresca: largest tangential traction; must be set",
                "",
                "set it in MPa, or set Law = frictionless"}},
              [](const auto &numbers) {
                ContactLaw<dim> law;
                law.has_friction = law.acts_when_open = true;
                law.fixed                             = numbers[0];
                return law;
              },
              true};
    }

    template <int dim>
    LawKind<dim> coulomb_law()
    {
      return {"Coulomb",
              "friction in proportion to the pressure",
              {{"Friction coefficient",
                "-",
                "Coulomb: tangential traction over pressure when slipping; must be set",
                "",
                "set it, or set Law = frictionless"}},
              [](const auto &numbers) {
                ContactLaw<dim> law;
                law.has_friction = true;
                law.coefficient  = numbers[0];
                return law;
              }};
    }
  } // namespace

  template <int dim>
  double LawNumber<dim>::at(const dealii::Point<dim> &x, const double t, const std::string &pair) const
  {
    const double number = value.value(x, t);
    if (!(number >= 0 && std::isfinite(number)))
      throw InputError(format("Contact %s/%s is %g%s at %s",
                              pair.c_str(),
                              name.c_str(),
                              number,
                              unit == "-" ? "" : (" " + unit).c_str(),
                              point_text(x, dim).c_str()),
                       "it must be zero or positive everywhere on the slave boundary");
    return number;
  }

  template <int dim>
  qp::NodeSet ContactLaw<dim>::admissible_forces(const dealii::Point<dim> &x,
                                                 const double              t,
                                                 const double              area,
                                                 const std::string        &pair) const
  {
    qp::NodeSet set;
    if (fixed)
      set.fixed = fixed->at(x, t, pair) * area;
    if (coefficient)
      set.coefficient = coefficient->at(x, t, pair);
    if (cap)
      set.cap = cap->at(x, t, pair) * area;
    return set;
  }

  template <int dim>
  const std::vector<LawKind<dim>> &law_kinds()
  {
    static const std::vector<LawKind<dim>> kinds = {bonded_law<dim>(),
                                                    frictionless_law<dim>(),
                                                    tresca_law<dim>(),
                                                    coulomb_law<dim>(),
                                                    cohesion_law<dim>()};
    return kinds;
  }

  template <int dim>
  ContactLaw<dim> LawKind<dim>::law(const std::vector<std::optional<LawNumber<dim>>> &numbers) const
  {
    ContactLaw<dim> result = make(numbers);
    result.name            = name;
    return result;
  }

  template <int dim>
  ContactLaw<dim> make_law(const std::string &name, const std::vector<std::string> &numbers)
  {
    for (const auto &kind : law_kinds<dim>())
      if (kind.name == name)
        {
          std::vector<std::optional<LawNumber<dim>>> values(kind.parameters.size());
          for (unsigned int i = 0; i < values.size(); ++i)
            if (const auto &[parameter, unit, meaning, default_text, remedy] = kind.parameters[i];
                numbers.at(i) != default_text)
              values[i] = {parameter, unit, Field<dim>(numbers[i], parameter)};
          return kind.law(values);
        }
    throw std::out_of_range("no law " + name);
  }

  template struct LawNumber<2>;
  template struct LawNumber<3>;
  template struct ContactLaw<2>;
  template struct ContactLaw<3>;
  template struct LawKind<2>;
  template struct LawKind<3>;
  template const std::vector<LawKind<2>> &law_kinds();
  template const std::vector<LawKind<3>> &law_kinds();
  template ContactLaw<2>                  make_law(const std::string &, const std::vector<std::string> &);
  template ContactLaw<3>                  make_law(const std::string &, const std::vector<std::string> &);
} // namespace slipstick::scene
