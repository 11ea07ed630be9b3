// Dense problems with equalities that can be restricted to free and tied entries, as the Newton method requires.
#pragma once

#include "support.h"

#include <slipstick/qp/pressure_bounds.h>

namespace slipstick::qp::test
{
  /// A dense problem with G x = e that can be restricted to free and tied entries.
  struct FacedProblem : DenseProblem
  {
    FacedProblem(const Matrix &F_, const Matrix &G_, const Vector &e_)
      : DenseProblem(F_, G_)
      , e(e_)
    {}

    class Face
    {
    public:
      Face(const FacedProblem      &problem_,
           const std::vector<bool> &free_,
           const std::vector<Tie>  &ties_,
           const std::vector<Turn> &turns_)
        : problem(problem_)
        , free(free_)
        , ties(ties_)
        , turns(turns_)
        , G(problem_.G)
      {
        for (std::size_t k = 0; k < G.m; ++k)
          {
            Vector row(G.n);
            for (std::size_t j = 0; j < G.n; ++j)
              row[j] = G(k, j);
            turn(turns, row);
            for (std::size_t j = 0; j < G.n; ++j)
              G(k, j) = row[j];
          }
      }

      void multiply(const Vector &x, Vector &y) const
      {
        problem.multiply(x, y);
      }

      const SerialReduction &reduction() const
      {
        return problem.reduction();
      }

      const std::vector<double> *dependent_compliances() const
      {
        return problem.dependent_compliances();
      }

      void project_range(const Vector &x, Vector &y) const
      {
        Vector at = x;
        turn(turns, at);
        const Vector z = transposed(amplitudes(masked(at), false));
        for (std::size_t i = 0; i < x.size(); ++i)
          y[i] = free[i] ? z[i] : at[i];
        turn_back(turns, y);
      }

      void multiplier_shift(const Vector &v, Vector &y) const
      {
        Vector at = v;
        turn(turns, at);
        y = transposed(amplitudes(masked(at), false));
        turn_back(turns, y);
      }

      void balance(Vector &x) const
      {
        turn(turns, x);
        move_by(minus(problem.e, G * x), x);
        turn_back(turns, x);
      }

      void project_kernel(Vector &p) const
      {
        turn(turns, p);
        for (const Tie &tie : ties)
          p[tie.tied] = tie.factor * p[tie.to];
        Vector moving = masked(p);
        for (const Tie &tie : ties)
          moving[tie.tied] = p[tie.tied];
        Vector minus_Gp = G * moving;
        for (double &entry : minus_Gp)
          entry = -entry;
        move_by(minus_Gp, p);
        turn_back(turns, p);
      }

      void clear_held(Vector &p) const
      {
        turn(turns, p);
        for (std::size_t i = 0; i < p.size(); ++i)
          if (!free[i] && std::none_of(ties.begin(), ties.end(), [i](const Tie &tie) { return tie.tied == i; }))
            p[i] = 0;
        turn_back(turns, p);
      }

      void precondition(const Vector &r, Vector &z) const
      {
        Vector at = r;
        turn(turns, at);
        for (std::size_t i = 0; i < r.size(); ++i)
          z[i] = free[i] ? at[i] / problem.F(i, i) : 0.;
        turn_back(turns, z);
      }

      bool is_regular() const
      {
        return solve(gram(false), Vector(G.m, 1.)).has_value();
      }

    private:
      Vector masked(Vector x) const
      {
        for (std::size_t i = 0; i < x.size(); ++i)
          x[i] = free[i] ? x[i] : 0.;
        return x;
      }

      // column i of G, with those of the entries tied to it
      double column(const std::size_t k, const std::size_t i, const bool with_ties) const
      {
        double value = G(k, i);
        for (const Tie &tie : ties)
          if (with_ties && tie.to == i)
            value += tie.factor * G(k, tie.tied);
        return value;
      }

      Matrix gram(const bool with_ties) const
      {
        Matrix A(G.m, G.m);
        for (std::size_t k = 0; k < A.m; ++k)
          for (std::size_t l = 0; l < A.m; ++l)
            for (std::size_t i = 0; i < free.size(); ++i)
              A(k, l) += free[i] ? column(k, i, with_ties) * column(l, i, with_ties) : 0.;
        return A;
      }

      Vector amplitudes(const Vector &x, const bool with_ties) const
      {
        return *solve(gram(with_ties), G * x);
      }

      Vector transposed(const Vector &a) const
      {
        Vector y(free.size(), 0.);
        for (std::size_t k = 0; k < a.size(); ++k)
          for (std::size_t i = 0; i < y.size(); ++i)
            y[i] += G(k, i) * a[k];
        return y;
      }

      // x += T y with the smallest y that changes G x by c
      void move_by(const Vector &c, Vector &x) const
      {
        const Vector a = *solve(gram(true), c);
        Vector       step(free.size(), 0.);
        for (std::size_t i = 0; i < free.size(); ++i)
          for (std::size_t k = 0; k < a.size() && free[i]; ++k)
            step[i] += column(k, i, true) * a[k];
        for (const Tie &tie : ties)
          step[tie.tied] = tie.factor * step[tie.to];
        add(1., step, x);
      }

      const FacedProblem &problem;
      std::vector<bool>   free;
      std::vector<Tie>    ties;
      std::vector<Turn>   turns;
      Matrix              G; // for the turned entries
    };

    Face face(const std::vector<bool> &free, const std::vector<Tie> &ties, const std::vector<Turn> &turns = {}) const
    {
      return Face(*this, free, ties, turns);
    }

    const std::vector<double> *dependent_compliances() const
    {
      return compliances.empty() ? nullptr : &compliances;
    }

    const FacedProblem &loose_bodies() const
    {
      return *this;
    }

    /// Frees the entries with the smallest gaps until the face is regular.
    std::vector<bool> hold(std::vector<bool>          free,
                           const std::vector<double> &gaps,
                           const bool,
                           const std::vector<Turn> &) const
    {
      while (!face(free, {}).is_regular())
        {
          std::size_t next = free.size();
          for (std::size_t i = 0; i < free.size(); ++i)
            if (!free[i] && (next == free.size() || gaps[i] < gaps[next]))
              next = i;
          if (next == free.size())
            break;
          free[next] = true;
        }
      return free;
    }

    Vector e;
    Vector compliances; // of dependent entries
  };
} // namespace slipstick::qp::test
