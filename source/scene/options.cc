#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace slipstick::scene
{
  namespace
  {
    const unsigned int max_iterations = 1000000000;

    // Lower limit for Tolerance = auto if no estimate of the discretisation error stops the solver earlier, e.g. if the
    // solution is in the finite element space.
    constexpr double least_automatic_tolerance = 1e-8;

    void declare_smalbe(dealii::ParameterHandler &prm, qp::SmalbeOptions &smalbe)
    {
      using qp::Expansion;
      prm.enter_subsection("SMALBE");
      add_choice(prm,
                 "Expansion",
                 smalbe.inner.expansion,
                 Choices<Expansion>{{"gradient projection", Expansion::gradient_projection},
                                    {"boundary then projection", Expansion::boundary_then_projection},
                                    {"projected CG", Expansion::projected_cg}},
                 "what MPGP does when a conjugate gradient step would leave the bounds");
      add_number(prm,
                 "Proportioning",
                 smalbe.inner.proportioning,
                 "-",
                 Interval::above(0),
                 "Gamma: how much the chopped gradient may exceed the free one (Dostal 2009, section 5.8)");
      add_number(prm,
                 "Step length",
                 smalbe.inner.step_length,
                 "-",
                 Interval{0, 2, true, false},
                 "fixed step alpha times the norm of the Hessian");
      add_number(prm,
                 "Initial balance",
                 smalbe.initial_balance,
                 "-",
                 Interval::above(0),
                 "M0: inner precision relative to the violation of G x = 0, Hessian scaled to norm 1");
      add_number(prm,
                 "Balance reduction",
                 smalbe.balance_reduction,
                 "-",
                 Interval::above(1),
                 "beta: M is divided by it when the Lagrangian did not increase enough");
      add_number(prm,
                 "Regularization",
                 smalbe.regularization,
                 "-",
                 Interval::above(0),
                 "penalty rho over the norm of P F P");
      add_count(prm,
                "Max outer iterations",
                smalbe.max_outer_iterations,
                1,
                max_iterations,
                "largest number of multiplier updates");
      add_count(prm,
                "Max inner iterations",
                smalbe.inner.max_iterations,
                1,
                max_iterations,
                "MPGP steps per outer iteration");
      prm.leave_subsection();
    }

    void declare_tolerance(dealii::ParameterHandler &prm, SolverOptions &solver)
    {
      const Interval interval = Interval::inside(0, 1);
      add_entry(
        prm,
        "Tolerance",
        number_text(solver.tolerance),
        "-",
        "eps: projected gradient and G x relative to P d; auto: ends when the algebraic error is a small part of the "
        "estimated discretisation error, both in the energy norm",
        "auto, or a number" + interval.text(),
        [interval](const std::string &text) {
          const auto number = parse_number(text);
          return text == "auto" || (number && interval.contains(*number));
        },
        [&solver](const std::string &text) {
          solver.stops_at_discretization_error = text == "auto";
          solver.tolerance                     = text == "auto" ? least_automatic_tolerance : *parse_number(text);
        });
    }

    void declare_dual(dealii::ParameterHandler &prm, tfeti::DualOptions &dual)
    {
      using tfeti::DualOperatorKind;
      using tfeti::Precision;
      using tfeti::Preconditioner;
      add_choice(prm,
                 "Preconditioner",
                 dual.preconditioner,
                 Choices<Preconditioner>{{"auto", Preconditioner::automatic},
                                         {"none", Preconditioner::none},
                                         {"lumped", Preconditioner::lumped},
                                         {"Dirichlet", Preconditioner::dirichlet}},
                 "preconditioner of the dual problem");
      add_choice(prm,
                 "Dual operator",
                 dual.dual_operator,
                 Choices<DualOperatorKind>{{"auto", DualOperatorKind::automatic},
                                           {"explicit", DualOperatorKind::explicit_blocks},
                                           {"implicit", DualOperatorKind::implicit}},
                 "F by dense blocks (explicit) or by a forward and backward solve per multiplication (implicit); auto: "
                 "explicit where the blocks fit into memory and save time");
      const Choices<Precision> precisions{{"double", Precision::double_precision},
                                          {"single", Precision::single_precision}};
      add_choice(prm,
                 "Operator precision",
                 dual.operator_precision,
                 precisions,
                 "storage of the explicit dual operator; single: half the memory, and the solution is corrected by "
                 "residuals in double, so that its accuracy is the same");
      add_choice(prm,
                 "Preconditioner precision",
                 dual.preconditioner_precision,
                 precisions,
                 "storage of the preconditioner, which the accuracy of the solution does not depend on");
      prm.enter_subsection("Norm estimate");
      add_count(prm,
                "Max iterations",
                dual.max_norm_iterations,
                1,
                max_iterations,
                "steps of Lanczos' method for the norm of P F P");
      add_number(prm,
                 "Tolerance",
                 dual.norm_tolerance,
                 "-",
                 Interval::inside(0, 1),
                 "relative change at which it stops");
      prm.leave_subsection();
    }
  } // namespace

  void declare(dealii::ParameterHandler &prm, Decomposition &decomposition)
  {
    prm.enter_subsection("Decomposition");
    add_choice(prm,
               "Method",
               decomposition.method,
               Choices<DecompositionMethod>{{"auto", DecompositionMethod::automatic},
                                            {"blocks", DecompositionMethod::blocks},
                                            {"METIS", DecompositionMethod::metis},
                                            {"none", DecompositionMethod::none}},
               "blocks: N x N of every rectangle; METIS: graph partition; none: a subdomain per body; auto: blocks if "
               "all bodies are rectangles with Cells = auto, else METIS");
    add_count(prm, "Blocks", decomposition.blocks, 1, 1000, "N: N x N blocks of every rectangle");
    add_count(prm,
              "Cells per block",
              decomposition.cells_per_block,
              1,
              10000,
              "cells along each edge of a block; with Blocks it gives the mesh where Cells = auto");
    add_count_or_auto(prm,
                      "Subdomains",
                      decomposition.subdomains,
                      1000000,
                      "METIS: number of subdomains over all bodies, at least one each; auto: by the number of cells");
    add_count(prm, "Seed", decomposition.seed, 0, 1000000000, "METIS: seed of its random numbers");
    prm.leave_subsection();
  }

  void declare(dealii::ParameterHandler &prm, Discretization &discretization)
  {
    prm.enter_subsection("Discretization");
    add_count(prm, "Degree", discretization.degree, 1, 2, "polynomial degree of the elements");
    add_choice(
      prm,
      "Element",
      discretization.element,
      Choices<ElementKind>{{"standard", ElementKind::standard},
                           {"nearly incompressible", ElementKind::nearly_incompressible}},
      "nearly incompressible: for plane strain and solids with nu near 0.5, where standard elements lock; its dilatation is "
      "projected on polynomials of one degree less");
    add_count(prm, "Refinements", discretization.refinements, 0, 10, "extra uniform refinements of the mesh");
    prm.leave_subsection();
  }

  void declare(dealii::ParameterHandler &prm, SolverOptions &solver)
  {
    prm.enter_subsection("Solver");
    add_choice(
      prm,
      "Algorithm",
      solver.algorithm,
      Choices<Algorithm>{{"auto", Algorithm::automatic},
                         {"smalbe", Algorithm::smalbe},
                         {"semismooth newton", Algorithm::semismooth_newton},
                         {"pcg", Algorithm::pcg}},
      "smalbe, semismooth newton: scenes with contact; pcg: linear scenes; auto: semismooth newton or pcg, by the scene");
    declare_tolerance(prm, solver);
    add_flag(prm,
             "Prune contact",
             solver.prune_contact,
             "no multipliers for contact nodes that are far apart, unless the solution makes them penetrate");
    declare_dual(prm, solver.dual);
    declare_smalbe(prm, solver.smalbe);
    prm.enter_subsection("PCG");
    add_count(prm, "Max iterations", solver.pcpg.max_iterations, 1, max_iterations, "maximum number of iterations");
    prm.leave_subsection();
    prm.leave_subsection();
  }

  void declare(dealii::ParameterHandler &prm, FrictionOptions &friction)
  {
    prm.enter_subsection("Friction");
    add_number(prm,
               "Tolerance",
               friction.tolerance,
               "-",
               Interval::inside(0, 1),
               "relative change of the slip bounds at which their iteration ends (Coulomb; Tresca where closed)");
    add_count(prm, "Max iterations", friction.max_iterations, 1, max_iterations, "updates of the slip bounds");
    prm.leave_subsection();
  }

  namespace
  {
    // Maximum number of load steps in one range: more are probably a mistake.
    constexpr double most_steps = 100000;

    /// The number in @p text; empty if it is not a finite number.
    std::vector<double> single_number(const std::string &text)
    {
      const auto number = parse_number(text);
      return number && std::isfinite(*number) ? std::vector<double>{*number} : std::vector<double>();
    }

    /// The numbers of "FIRST:STEP:LAST"; LAST is included if a whole number of steps leads to it, up to rounding. Empty
    /// if the text is not a range of increasing numbers.
    std::vector<double> range(const std::string &text)
    {
      std::vector<double> ends;
      for (const std::string &part : split_list(text, ':'))
        {
          const auto number = single_number(part);
          ends.insert(ends.end(), number.begin(), number.end());
        }
      if (ends.size() != 3 || std::count(text.begin(), text.end(), ':') != 2 || !(ends[1] > 0) || ends[2] < ends[0])
        return {};
      constexpr double rounding = 1e-9; // of the number of steps, relative: of decimal fractions, with a margin
      const double     n_steps = (ends[2] - ends[0]) / ends[1], whole = std::round(n_steps);
      const bool       meets = std::abs(n_steps - whole) < rounding * std::max(1., whole);
      if (!(n_steps < most_steps))
        return {};
      std::vector<double> numbers;
      for (unsigned int k = 0; k <= (meets ? whole : std::floor(n_steps)); ++k) // 0.3, not 0.30000000000000004
        numbers.push_back(meets && k == whole ? ends[2] : parse_number(format("%.12g", ends[0] + k * ends[1])).value());
      return numbers;
    }
  } // namespace

  void declare_load_steps(dealii::ParameterHandler &prm, std::vector<double> &factors)
  {
    const auto parse = [](const std::string &text) {
      std::vector<double> numbers;
      for (const std::string &part : split_list(text))
        {
          const auto some = part.find(':') == std::string::npos ? single_number(part) : range(part);
          if (some.empty())
            return std::vector<double>();
          numbers.insert(numbers.end(), some.begin(), some.end());
        }
      return numbers;
    };
    std::string text;
    for (const double factor : factors)
      text += (text.empty() ? "" : ", ") + number_text(factor);
    prm.enter_subsection("Load steps");
    add_entry(
      prm,
      "Factors",
      text,
      "",
      "load factors t of the steps, in order; slip is measured from the end of the previous step",
      format("increasing numbers, separated by commas, or ranges FIRST:STEP:LAST such as 0:0.1:1 of less than %g steps",
             most_steps),
      [parse](const std::string &list) {
        const auto numbers = parse(list);
        return !numbers.empty() &&
               std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal<double>()) == numbers.end();
      },
      [parse, &factors](const std::string &list) { factors = parse(list); });
    prm.leave_subsection();
  }

  void declare(dealii::ParameterHandler &prm, OutputOptions &output)
  {
    prm.enter_subsection("Output");
    add_flag(prm, "VTU", output.vtu, "write the fields for ParaView");
    prm.leave_subsection();
  }
} // namespace slipstick::scene
