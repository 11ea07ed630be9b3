// Contact law between two sides. It is fully defined by a set of numbers; laws do not differ in anything else.
#pragma once

#include <slipstick/qp/node_set.h>
#include <slipstick/scene/field.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A number of a law, named as in the .prm; it may depend on the position on the boundary and on the load factor.
  template <int dim>
  struct LawNumber
  {
    std::string name, unit;
    Field<dim>  value;

    /// @throws InputError (on the calling rank) for a negative number, naming @p pair.
    double at(const dealii::Point<dim> &x, const double t, const std::string &pair) const;
  };

  template <int dim>
  struct ContactLaw
  {
    std::string name           = "frictionless";
    bool        is_bonded      = false; // normal and tangential forces are unbounded: both rows are equalities
    bool        has_friction   = false; // tangential forces are bounded; the bounds ...
    bool        acts_when_open = false; // ... are the fixed ones, for closed and open nodes alike

    std::optional<LawNumber<dim>> fixed, coefficient, cap; // of qp::NodeSet: [MPa] (none: 0), [-] (0), [MPa] (no cap)

    /// The numbers that the law has.
    std::vector<const LawNumber<dim> *> numbers() const
    {
      std::vector<const LawNumber<dim> *> all;
      for (const auto *number : {&fixed, &coefficient, &cap})
        if (*number)
          all.push_back(&**number);
      return all;
    }

    /// Whether nodes have a tangential row.
    bool has_tangential_row() const
    {
      return is_bonded || has_friction;
    }

    /// Whether the law exerts no forces on open nodes, so that these may have no rows.
    bool acts_where_closed_alone() const
    {
      return !is_bonded && !acts_when_open;
    }

    /// Admissible forces [N] at a closed node with this tributary area [mm^2]; not for bonds.
    /// @throws InputError (on the calling rank) for a negative number, naming @p pair.
    qp::NodeSet admissible_forces(const dealii::Point<dim> &x,
                                  const double              t,
                                  const double              area,
                                  const std::string        &pair) const;
  };

  /// A parameter of a law in the .prm, a FIELD >= 0. Parameters with the same name in two laws are the same parameter.
  struct LawParameter
  {
    std::string name, unit, meaning;
    std::string default_text; // "none": no number; empty: must be set ...
    std::string remedy;       // ... with this remedy if it is not
  };

  /// A law as named in the .prm, and its construction from the parameters.
  template <int dim>
  struct LawKind
  {
    std::string               name, meaning;
    std::vector<LawParameter> parameters;
    ContactLaw<dim> (*make)(const std::vector<std::optional<LawNumber<dim>>> &numbers);
    bool can_act_when_open = false; // the parameter "Slip bound acts on" chooses

    /// @param numbers in the order of the parameters; no value for "none".
    ContactLaw<dim> law(const std::vector<std::optional<LawNumber<dim>>> &numbers) const;
  };

  /// All laws. A new law needs a file such as cohesion.cc and an entry here.
  template <int dim>
  const std::vector<LawKind<dim>> &law_kinds();

  /// The law with this name, with numbers as texts of the .prm in the order of its parameters.
  template <int dim>
  ContactLaw<dim> make_law(const std::string &name, const std::vector<std::string> &numbers = {});

  /// cohesion.cc: |t_T| <= min(cohesion + friction coefficient * pressure, shear limit) where the pair is closed.
  template <int dim>
  LawKind<dim> cohesion_law();
} // namespace slipstick::scene
