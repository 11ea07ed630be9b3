// What acts between two sides that touch: a law with its numbers. Nothing else tells one law from another.
#pragma once

#include <slipstick/qp/node_set.h>
#include <slipstick/scene/field.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A number of a law as the .prm names it, which may vary over the boundary and with the load factor.
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
    bool        is_bonded      = false; // neither normal nor tangential forces have bounds: both rows are equalities
    bool        has_friction   = false; // tangential forces between bounds, which ...
    bool        acts_when_open = false; // ... are the fixed ones whether a node is closed or not

    std::optional<LawNumber<dim>> fixed, coefficient, cap; // of qp::NodeSet: [MPa] (none: 0), [-] (0), [MPa] (no cap)

    /// Have nodes a row along the tangent?
    bool has_tangential_row() const
    {
      return is_bonded || has_friction;
    }

    /// Does it say nothing of nodes that stay open, so that they may go without rows?
    bool acts_where_closed_alone() const
    {
      return !is_bonded && !acts_when_open;
    }

    /// Forces [N] that it admits at a node of this tributary area [mm^2], but for bonds and as if the node were closed.
    /// @throws InputError (on the calling rank) for a negative number, naming @p pair.
    qp::NodeSet admissible_forces(const dealii::Point<dim> &x,
                                  const double              t,
                                  const double              area,
                                  const std::string        &pair) const;
  };

  /// A parameter of a law in the .prm, a FIELD >= 0. The same name in two laws is one parameter.
  struct LawParameter
  {
    std::string name, unit, meaning;
    std::string default_text; // "none": no number; empty: it must be set ...
    std::string remedy;       // ... and what to do where it is not
  };

  /// A law as the .prm names it, and how to make it of its parameters.
  template <int dim>
  struct LawKind
  {
    std::string               name, meaning;
    std::vector<LawParameter> parameters;
    ContactLaw<dim> (*make)(const std::vector<std::optional<LawNumber<dim>>> &numbers);

    /// @p numbers in the order of the parameters, nothing for "none".
    ContactLaw<dim> law(const std::vector<std::optional<LawNumber<dim>>> &numbers) const;
  };

  /// All of them. A new one is a file such as cohesion.cc and its entry here.
  template <int dim>
  const std::vector<LawKind<dim>> &law_kinds();

  /// The law of a name, with numbers as the .prm would say them in the order of its parameters.
  template <int dim>
  ContactLaw<dim> make_law(const std::string &name, const std::vector<std::string> &numbers = {});

  /// cohesion.cc: |t_T| <= min(cohesion + friction coefficient * pressure, shear limit) where the pair is closed.
  template <int dim>
  LawKind<dim> cohesion_law();
} // namespace slipstick::scene
