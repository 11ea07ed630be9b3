// Scenes made in code; the torn problem of a scene; its matrices as dense ones, the same on every rank; the untorn
// bodies as an independent reference.
#pragma once

#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/tfeti/dense.h>
#include <slipstick/tfeti/face.h>
#include <slipstick/tfeti/recovery.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace slipstick::test
{
  using Scene = scene::Scene<2>;
  using Point = dealii::Point<2>;

  // ---------------------------------------------------------------------------------------------- scenes

  scene::Field<2> field(const std::string &formula);

  struct Cut
  {
    scene::DecompositionMethod method;
    unsigned int               n; // blocks per direction, or METIS subdomains
  };
  Cut whole();
  Cut blocks(const unsigned int n);
  Cut metis(const unsigned int n);

  Scene cut(Scene scene, const Cut &how);

  void add_body(Scene                             &scene,
                const std::string                 &name,
                const Point                       &origin,
                const Point                       &size,
                const std::array<unsigned int, 2> &cells);

  /// Empty formulas leave a component free.
  void support(Scene             &scene,
               const unsigned int body,
               const std::string &boundary,
               const std::string &x,
               const std::string &y);

  void touch(Scene                      &scene,
             const scene::BoundaryName  &slave,
             const scene::BoundaryName  &master,
             const scene::ContactLaw<2> &law);

  void load(Scene             &scene,
            const unsigned int body,
            const std::string &boundary,
            const std::string &x,
            const std::string &y);

  /// Contact with a circle; an empty slip bound means no friction.
  void touch(Scene             &scene,
             const unsigned int body,
             const std::string &boundary,
             const Point       &center,
             const double       radius,
             const std::string &slip_bound);

  /// The paper's box without its conditions, n x n cells in one piece.
  Scene box(const unsigned int n, const unsigned int degree = 1);

  /// The box bent and twisted: no symmetry, all conditions formulas.
  Scene bent_box(const unsigned int n, const unsigned int degree = 1);

  /// The paper's box on its circle.
  Scene box_on_circle(const unsigned int n, const std::string &slip_bound, const unsigned int degree = 1);

  /// Two bodies of different stiffness and size, each held and bent.
  Scene two_bodies(const unsigned int n);

  // ---------------------------------------------------------------------------------------------- torn

  std::vector<std::string> body_names(const Scene &scene);

  /// Everything up to the dual problem.
  struct Torn
  {
    explicit Torn(const Scene &scene, const MPI_Comm comm = MPI_COMM_WORLD, const double t = 1);

    std::unique_ptr<tfeti::DualProblem> dual(const tfeti::DualOptions &options) const;
    std::unique_ptr<tfeti::DualProblem> dual() const;

    Scene                                 scene;
    MPI_Comm                              comm;
    mesh::Mesh<2>                         mesh;
    mechanics::Spaces<2>                  spaces;
    std::vector<tfeti::SubdomainMatrices> matrices;
    tfeti::Constraints                    constraints;
  };

  // ---------------------------------------------------------------------------------------------- gathering

  /// The lists of all ranks, one after the other.
  template <typename T>
  std::vector<T> gathered(const std::vector<T> &own, const MPI_Comm comm)
  {
    std::vector<T> all;
    for (const auto &part : dealii::Utilities::MPI::all_gather(comm, own))
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  Eigen::VectorXd gathered(const tfeti::DistributedVector &x, const MPI_Comm comm);

  /// This rank's part of a vector that all ranks have.
  tfeti::DistributedVector distributed(const Eigen::VectorXd &x, const tfeti::DualProblem &dual);

  /// Numbers in (-1, 1), the same on all ranks, different for every seed.
  Eigen::VectorXd random_vector(const unsigned int n, const unsigned int seed);

  /// Eigenvalues below 1e-11 of the largest count as zero.
  Eigen::MatrixXd moore_penrose(const Eigen::MatrixXd &A);

  Eigen::MatrixXd full(const Eigen::SparseMatrix<double> &lower);

  /// The whole torn problem, dense, on every rank: unknowns by subdomain, rows by global number.
  struct Dense
  {
    explicit Dense(const Torn &torn);

    /// Moore-Penrose inverse of K, subdomain by subdomain.
    Eigen::MatrixXd pseudo_inverse() const;

    /// Projector on the kernel of G.
    Eigen::MatrixXd P() const;

    Eigen::MatrixXd PFP() const;

    std::vector<unsigned int>   first; // unknown of every subdomain
    Eigen::MatrixXd             K, R, B, G;
    Eigen::VectorXd             f, c, e;
    std::vector<tfeti::RowKind> kind;
  };

  double smallest_singular_value(const Eigen::MatrixXd &A);

  /// |a - b| over |b|
  double relative_difference(const Eigen::MatrixXd &a, const Eigen::MatrixXd &b);

  // ---------------------------------------------------------------------------------------------- fields by position

  using NodalField = std::vector<std::array<double, 4>>; // x, y, u_x, u_y

  std::vector<Point> node_positions(const mechanics::Spaces<2> &spaces, const unsigned int p);

  /// All copies of all nodes of all ranks.
  NodalField nodal_field(const Torn &torn, const std::vector<Eigen::VectorXd> &u);

  std::array<long long, 2> position_key(const double x, const double y, const double unit);

  /// Largest difference of nodes at the same place over the largest displacement; 1 when the places differ.
  double largest_difference(const NodalField &a, const NodalField &b);

  // ---------------------------------------------------------------------------------------------- untorn

  bool lies_on(const scene::Body<2> &body, const std::string &boundary, const Point &x);

  /// The bodies in one piece each, their supports eliminated; known to this rank alone.
  class Untorn
  {
  public:
    explicit Untorn(const Scene &scene);

    /// Displacements of body b under forces at its nodes, with the prescribed displacements times @p with_prescribed.
    Eigen::VectorXd displacements(const unsigned int b, Eigen::VectorXd forces, const double with_prescribed) const;

    /// Displacements under the loads of the scene.
    NodalField solution() const;

    Torn                                                                             torn;
    std::vector<std::vector<Point>>                                                  positions; // nodes, by body
    std::vector<std::vector<std::optional<double>>>                                  held;      // unknowns, by body
    std::vector<std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>> factors;
  };

  // ---------------------------------------------------------------------------------------------- errors

  /// The message of the E that @p run throws, the same on every rank; fails the test when a rank gets none or another.
  template <typename E, typename Run>
  std::string message_on_all_ranks(const Run &run)
  {
    std::string message;
    try
      {
        run();
      }
    catch (const E &error)
      {
        message = error.what();
      }
    EXPECT_FALSE(message.empty()) << "not thrown";
    for (const auto &other : dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, message))
      EXPECT_EQ(message, other);
    return message;
  }
} // namespace slipstick::test
