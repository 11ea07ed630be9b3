// The linear problem of a face: P(d - F x) = 0 on the free entries, while bounds, ties and G x remain as at the start.
// Directions of all earlier faces are used as far as this one admits them (direction_store.h).
//
// A face may be regularised: a compliance eps D of dependent entries, without strain at a given force, is added to F.
// If F is singular, the solution is then unique: the one nearest to that force (proximal point).
//
// Faces without ties are solved by conjugate gradients (Farhat, Crivelli, Roux 1994, with full orthogonalisation). Ties
// make the operator unsymmetric; then generalised conjugate residuals are used (Eisenstat, Elman, Schultz 1983), which
// also endure stiffnesses that differ by many orders of magnitude.
#pragma once

#include <slipstick/qp/face_conjugate_gradients.h>
#include <slipstick/qp/face_conjugate_residuals.h>
#include <slipstick/qp/face_iterate.h>

#include <utility>
#include <vector>

namespace slipstick::qp
{
  /// Solves a face with directions from the store, and adds new ones to it.
  ///
  /// @code
  /// using namespace test; // FacedProblem: a dense problem with faces, tests/qp/faced_problem.h
  /// Matrix G(1, 3);
  /// G(0, 0) = G(0, 1) = G(0, 2) = std::sqrt(1. / 3);
  /// const FacedProblem      problem(diagonal({1, 1, 1}), G, {0});
  /// const auto              face = problem.face({true, true, false}, {}); // x_2 stays at its bound
  /// DirectionStore<Vector>  store(10);
  /// const auto              at_bound = [](const Vector &p) { return Vector{p[2]}; };
  /// const FaceSolverOptions options;
  /// const Vector            d{3, 1, 5}, x{-1, 0, 1}; // G x = 0
  /// FaceSolver<Vector, FacedProblem::Face> solver(face, d, store, at_bound, options);
  /// solver.start(x, problem.F * x);
  /// const auto best = solver.solve_symmetric(1e-12);
  /// assert(std::abs(best.x[0] - 0.5) < 1e-12 && std::abs(best.x[1] + 1.5) < 1e-12 && best.x[2] == 1);
  /// @endcode
  template <typename Vector, typename Face>
  class FaceSolver
  {
  public:
    /// @param face, d, store, options are kept by reference. @param conditions as in admissible_combinations().
    /// @param turns of the face; their compliances C are added to F.
    /// @param regularization eps >= 0; > 0 only with dependent_compliances() of the face
    template <typename Conditions>
    FaceSolver(const Face              &face,
               const Vector            &d,
               DirectionStore<Vector>  &store,
               const Conditions        &conditions,
               const FaceSolverOptions &options,
               std::vector<Turn>        turns          = {},
               const double             regularization = 0)
      : at(face, d, store, conditions, options, std::move(turns), regularization)
    {}

    /// @param product F x. @param error_of_product by rounding, weighted. @param center force at which eps D has no
    /// strain.
    /// @return the weighted residual |P(d - F x - eps D (x - center))|.
    double start(Vector x, Vector product, const double error_of_product, const Vector &center)
    {
      at.start(std::move(x), std::move(product), error_of_product, center);
      return at.residual_norm();
    }

    /// The same without regularisation.
    double start(Vector x, Vector product, const double error_of_product = 0)
    {
      at.start(std::move(x), std::move(product), error_of_product);
      return at.residual_norm();
    }

    /// Conjugate gradients from the start until the weighted residual is at most @p target. For faces without ties.
    FaceSolution<Vector> solve_symmetric(const double target)
    {
      return solve(detail::FaceConjugateGradients<Vector, Face>(at), target);
    }

    /// The same by generalised conjugate residuals, for all faces.
    FaceSolution<Vector> solve_unsymmetric(const double target)
    {
      return solve(detail::FaceConjugateResiduals<Vector, Face>(at), target);
    }

  private:
    template <typename Method>
    FaceSolution<Vector> solve(Method method, const double target)
    {
      method.use_store(target);
      while (!at.is_solved(target))
        {
          if (!at.has_steps_left())
            return at.ended(Status::iteration_limit);
          if (const auto failure = method.step())
            return at.ended(*failure);
        }
      return at.ended(Status::converged);
    }

    detail::FaceIterate<Vector, Face> at;
  };
} // namespace slipstick::qp
