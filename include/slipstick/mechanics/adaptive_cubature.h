// Integrals of formulas over a face; pieces of the face are divided into four until two successive integrals agree.
#pragma once

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace slipstick::mechanics
{
  // Initial uniform divisions of the whole face: features narrower than about a fiftieth of it may be missed.
  constexpr unsigned int n_first_divisions = 2;
  // A piece and its four parts agree if they differ by at most this fraction of the integral of the magnitudes.
  constexpr double same_cubature = 1e-9;
  // Maximum number of further divisions of a piece: a jump is located to 1/256 of the face.
  constexpr unsigned int max_divisions = 6;
  // Limit on the number of pieces per face; only formulas that oscillate indefinitely need more.
  constexpr unsigned int max_pieces_of_face = 10000;

  /// n functions of the local coordinates of a face (the unit triangle or the unit square), evaluated together.
  template <std::size_t n>
  class AdaptiveCubature
  {
  public:
    using Place  = std::array<double, 2>;
    using Values = std::array<double, n>;

    /// @param f f(place), Values.
    template <class F>
    AdaptiveCubature(const unsigned int n_corners_, const F &f)
      : n_corners(n_corners_)
    {
      std::vector<std::pair<Piece, Values>> first;
      divide({{{0, 0}}, {{1, 0}}, {{0, 1}}}, n_first_divisions, [&](const Piece &piece) {
        first.emplace_back(piece, gauss(f, piece));
        scale += magnitude;
      });
      for (const auto &[piece, sum] : first)
        refine(f, piece, sum, 0);
    }

    Values integral{};
    double scale      = 0; // integral of the sum of magnitudes
    double difference = 0; // remaining difference, summed over all pieces

  private:
    /// A parallelogram or triangle.
    struct Piece
    {
      Place origin, a, b;
    };

    static Place moved(const Place &x, const Place &a, const double s, const Place &b, const double t)
    {
      return {{x[0] + s * a[0] + t * b[0], x[1] + s * a[1] + t * b[1]}};
    }

    std::array<Piece, 4> parts(const Piece &whole) const
    {
      const Place zero{}, a = moved(zero, whole.a, 0.5, whole.b, 0), b = moved(zero, whole.a, 0, whole.b, 0.5);
      const auto  at = [&](const double s, const double t) { return moved(whole.origin, a, s, b, t); };
      if (n_corners == 3)
        return {{{at(0, 0), a, b},
                 {at(1, 0), a, b},
                 {at(0, 1), a, b},
                 {at(1, 1), moved(zero, a, -1, b, 0), moved(zero, a, 0, b, -1)}}};
      return {{{at(0, 0), a, b}, {at(1, 0), a, b}, {at(0, 1), a, b}, {at(1, 1), a, b}}};
    }

    template <class Action>
    void divide(const Piece &piece, const unsigned int n_divisions, const Action &action)
    {
      if (n_divisions == 0)
        action(piece);
      else
        for (const Piece &part : parts(piece))
          divide(part, n_divisions - 1, action);
    }

    /// Exact for polynomials of degree 5.
    const dealii::Quadrature<2> &rule() const
    {
      static const dealii::QWitherdenVincentSimplex<2> triangle(3);
      static const dealii::QGauss<2>                   square(3);
      return n_corners == 3 ? static_cast<const dealii::Quadrature<2> &>(triangle) : square;
    }

    /// Sets the magnitude.
    template <class F>
    Values gauss(const F &f, const Piece &piece)
    {
      const double area = std::abs(piece.a[0] * piece.b[1] - piece.a[1] * piece.b[0]);
      Values       sum{};
      ++n_pieces;
      magnitude = 0;
      for (unsigned int q = 0; q < rule().size(); ++q)
        {
          const auto  &s      = rule().point(q);
          const Values at     = f(moved(piece.origin, piece.a, s[0], piece.b, s[1]));
          const double weight = area * rule().weight(q);
          for (unsigned int i = 0; i < n; ++i)
            {
              sum[i] += weight * at[i];
              magnitude += weight * std::abs(at[i]);
            }
        }
      return sum;
    }

    template <class F>
    void refine(const F &f, const Piece &whole, const Values &of_whole, const unsigned int divisions)
    {
      const auto            pieces = parts(whole);
      std::array<Values, 4> of_parts;
      Values                sum{};
      for (unsigned int k = 0; k < 4; ++k)
        {
          of_parts[k] = gauss(f, pieces[k]);
          for (unsigned int i = 0; i < n; ++i)
            sum[i] += of_parts[k][i];
        }
      double misfit = 0;
      for (unsigned int i = 0; i < n; ++i)
        misfit = std::max(misfit, std::abs(sum[i] - of_whole[i]));
      if (misfit > same_cubature * scale && divisions < max_divisions && n_pieces < max_pieces_of_face)
        {
          for (unsigned int k = 0; k < 4; ++k)
            refine(f, pieces[k], of_parts[k], divisions + 1);
          return;
        }
      difference += misfit;
      for (unsigned int i = 0; i < n; ++i)
        integral[i] += sum[i];
    }

    unsigned int n_corners;
    double       magnitude = 0;
    unsigned int n_pieces  = 0;
  };
} // namespace slipstick::mechanics
