// Scenes made in code; the torn problem of a scene; its matrices as dense ones, the same on every rank; the untorn
// bodies as an independent reference.
#pragma once

#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/tfeti/dual_problem.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

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

  inline scene::Field<2> field(const std::string &formula)
  {
    return scene::Field<2>(formula, "test");
  }

  struct Cut
  {
    scene::DecompositionMethod method;
    unsigned int               n; // blocks per direction, or METIS subdomains
  };
  inline Cut whole()
  {
    return {scene::DecompositionMethod::none, 1};
  }
  inline Cut blocks(const unsigned int n)
  {
    return {scene::DecompositionMethod::blocks, n};
  }
  inline Cut metis(const unsigned int n)
  {
    return {scene::DecompositionMethod::metis, n};
  }

  inline Scene cut(Scene scene, const Cut &how)
  {
    scene.decomposition.method     = how.method;
    scene.decomposition.blocks     = how.n;
    scene.decomposition.subdomains = how.n;
    return scene;
  }

  inline void add_body(Scene                             &scene,
                       const std::string                 &name,
                       const Point                       &origin,
                       const Point                       &size,
                       const std::array<unsigned int, 2> &cells)
  {
    scene::Material material;
    material.young_modulus = 1e5;
    material.poisson_ratio = 0.35;
    scene::Body<2> body;
    body.name     = name;
    body.origin   = origin;
    body.size     = size;
    body.cells    = cells;
    body.material = scene.materials.size();
    scene.materials.push_back(material);
    scene.bodies.push_back(body);
  }

  /// Empty formulas leave a component free.
  inline void support(Scene             &scene,
                      const unsigned int body,
                      const std::string &boundary,
                      const std::string &x,
                      const std::string &y)
  {
    scene::PrescribedDisplacement<2> support;
    support.name  = "held " + boundary;
    support.where = {body, boundary};
    if (!x.empty())
      support.components[0] = field(x);
    if (!y.empty())
      support.components[1] = field(y);
    scene.supports.push_back(support);
  }

  inline void touch(Scene                      &scene,
                    const scene::BoundaryName  &slave,
                    const scene::BoundaryName  &master,
                    const scene::ContactLaw<2> &law)
  {
    scene::ContactPair<2> pair;
    pair.name   = "pair";
    pair.slave  = slave;
    pair.master = master;
    pair.law    = law;
    scene.contacts.push_back(pair);
  }

  inline void load(Scene             &scene,
                   const unsigned int body,
                   const std::string &boundary,
                   const std::string &x,
                   const std::string &y)
  {
    scene.tractions.push_back({"load on " + boundary, {body, boundary}, {{field(x), field(y)}}, {}});
  }

  /// Contact with a circle; an empty slip bound means no friction.
  inline void touch(Scene             &scene,
                    const unsigned int body,
                    const std::string &boundary,
                    const Point       &center,
                    const double       radius,
                    const std::string &slip_bound)
  {
    scene::Obstacle<2> circle;
    circle.name   = "circle";
    circle.center = center;
    circle.radius = radius;
    scene::ContactPair<2> pair;
    pair.name     = "touches";
    pair.slave    = {body, boundary};
    pair.obstacle = scene.obstacles.size();
    if (!slip_bound.empty())
      pair.law = scene::make_law<2>("Tresca", {slip_bound});
    scene.obstacles.push_back(circle);
    scene.contacts.push_back(pair);
  }

  /// The paper's box without its conditions, n x n cells in one piece.
  inline Scene box(const unsigned int n, const unsigned int degree = 1)
  {
    Scene scene                 = cut({}, whole());
    scene.discretization.degree = degree;
    add_body(scene, "box", {0, 0}, {10, 10}, {{n, n}});
    return scene;
  }

  /// The box bent and twisted: no symmetry, all conditions formulas.
  inline Scene bent_box(const unsigned int n, const unsigned int degree = 1)
  {
    Scene scene               = box(n, degree);
    scene.bodies[0].thickness = 2;
    support(scene, 0, "left", "1e-3*y", "2e-3");
    support(scene, 0, "bottom", "", "2e-3 - 1e-5*x*x");
    load(scene, 0, "top", "10*x", "-250*sin(x)");
    load(scene, 0, "right", "30-y^2", "7*y");
    return scene;
  }

  /// The paper's box on its circle.
  inline Scene box_on_circle(const unsigned int n, const std::string &slip_bound, const unsigned int degree = 1)
  {
    Scene scene = box(n, degree);
    support(scene, 0, "left", "0", "0");
    load(scene, 0, "top", "0", "-250");
    touch(scene, 0, "bottom", {5, -20}, 20, slip_bound);
    return scene;
  }

  /// Two bodies of different stiffness and size, each held and bent.
  inline Scene two_bodies(const unsigned int n)
  {
    Scene scene = bent_box(n);
    add_body(scene, "beam", {20, 3}, {12, 4}, {{2 * n, n}});
    scene.materials[1].young_modulus = 7e4;
    support(scene, 1, "right", "0", "0");
    load(scene, 1, "left", "5", "20");
    return scene;
  }

  // ---------------------------------------------------------------------------------------------- torn

  inline std::vector<std::string> body_names(const Scene &scene)
  {
    std::vector<std::string> names;
    for (const auto &body : scene.bodies)
      names.push_back(body.name);
    return names;
  }

  /// Everything up to the dual problem.
  struct Torn
  {
    explicit Torn(const Scene &scene_, const MPI_Comm comm_ = MPI_COMM_WORLD, const double t = 1)
      : scene(scene_)
      , comm(comm_)
      , mesh(mesh::make_mesh(scene, comm))
      , spaces(mesh, scene.discretization.degree)
      , matrices(mechanics::assemble(scene, mesh, spaces, t))
      , constraints(interface::contact_constraints(scene, mesh, spaces, t))
    {}

    std::unique_ptr<tfeti::DualProblem> dual(const tfeti::DualOptions &options) const
    {
      return std::make_unique<tfeti::DualProblem>(matrices, constraints, options, body_names(scene), comm);
    }
    std::unique_ptr<tfeti::DualProblem> dual() const
    {
      return dual(scene.solver.dual);
    }

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

  inline Eigen::VectorXd gathered(const tfeti::DistributedVector &x, const MPI_Comm comm)
  {
    const auto all = gathered(std::vector<double>(x.begin(), x.end()), comm);
    return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
  }

  /// This rank's part of a vector that all ranks have.
  inline tfeti::DistributedVector distributed(const Eigen::VectorXd &x, const tfeti::DualProblem &dual)
  {
    tfeti::DistributedVector part  = dual.zero();
    const auto               first = part.get_partitioner()->local_range().first;
    for (unsigned int r = 0; r < part.locally_owned_size(); ++r)
      part.local_element(r) = x[first + r];
    return part;
  }

  /// Numbers in (-1, 1), the same on all ranks, different for every seed.
  inline Eigen::VectorXd random_vector(const unsigned int n, const unsigned int seed)
  {
    Eigen::VectorXd x(n);
    std::uint64_t   state = 88172645463325252ull + 7919ull * seed;
    for (unsigned int i = 0; i < n + 8; ++i)
      {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        if (i >= 8)
          x[i - 8] = static_cast<double>(state >> 11) / static_cast<double>(1ull << 52) - 1;
      }
    return x;
  }

  /// Eigenvalues below 1e-11 of the largest count as zero.
  inline Eigen::MatrixXd moore_penrose(const Eigen::MatrixXd &A)
  {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
    Eigen::VectorXd                                      inverse = eigen.eigenvalues();
    for (double &value : inverse)
      value = value > 1e-11 * eigen.eigenvalues().tail(1)[0] ? 1 / value : 0.;
    return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  }

  inline Eigen::MatrixXd full(const Eigen::SparseMatrix<double> &lower)
  {
    const Eigen::MatrixXd dense = lower;
    return dense.selfadjointView<Eigen::Lower>();
  }

  /// The whole torn problem, dense, on every rank: unknowns by subdomain, rows by global number.
  struct Dense
  {
    explicit Dense(const Torn &torn)
    {
      std::vector<unsigned int> sizes;
      for (const auto &system : torn.matrices)
        sizes.push_back(system.load.size());
      sizes = gathered(sizes, torn.comm);
      first.push_back(0);
      for (const unsigned int n : sizes)
        first.push_back(first.back() + n);

      using Triple = std::array<double, 3>;
      std::vector<Triple> k, r, b, g;
      for (unsigned int p = 0; p < torn.matrices.size(); ++p)
        {
          const auto        &system = torn.matrices[p];
          const unsigned int offset = first[system.subdomain];
          for (int column = 0; column < system.stiffness.outerSize(); ++column)
            for (Eigen::SparseMatrix<double>::InnerIterator entry(system.stiffness, column); entry; ++entry)
              k.push_back({{offset + double(entry.row()), offset + double(entry.col()), entry.value()}});
          for (int i = 0; i < system.kernel.rows(); ++i)
            {
              for (int j = 0; j < 3; ++j)
                r.push_back({{offset + double(i), 3. * system.subdomain + j, system.kernel(i, j)}});
              g.push_back({{offset + double(i), 0., system.load[i]}});
            }
          for (const auto &entry : torn.constraints.blocks[p])
            b.push_back(
              {{double(torn.constraints.rows->local_to_global(entry.row)), offset + double(entry.dof), entry.value}});
        }
      const auto matrix = [&](const std::vector<Triple> &own, const unsigned int rows, const unsigned int columns) {
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns);
        for (const auto &[i, j, value] : gathered(own, torn.comm))
          sum(static_cast<int>(i), static_cast<int>(j)) += value;
        return sum;
      };
      const unsigned int    n   = first.back();
      const Eigen::MatrixXd low = matrix(k, n, n);
      K                         = low.selfadjointView<Eigen::Lower>();
      R                         = matrix(r, n, 3 * sizes.size());
      B                         = matrix(b, torn.constraints.rows->size(), n);
      f                         = matrix(g, n, 1);
      const auto all_c          = gathered(torn.constraints.c, torn.comm);
      c                         = Eigen::Map<const Eigen::VectorXd>(all_c.data(), all_c.size());
      std::vector<unsigned int> kinds;
      for (const auto one : torn.constraints.kind)
        kinds.push_back(static_cast<unsigned int>(one));
      for (const unsigned int one : gathered(kinds, torn.comm))
        kind.push_back(static_cast<tfeti::RowKind>(one));
      G = R.transpose() * B.transpose();
      e = R.transpose() * f;
    }

    /// Moore-Penrose inverse of K, subdomain by subdomain.
    Eigen::MatrixXd pseudo_inverse() const
    {
      Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(K.rows(), K.cols());
      for (unsigned int s = 0; s + 1 < first.size(); ++s)
        {
          const unsigned int n                    = first[s + 1] - first[s];
          inverse.block(first[s], first[s], n, n) = moore_penrose(K.block(first[s], first[s], n, n));
        }
      return inverse;
    }

    /// Projector on the kernel of G.
    Eigen::MatrixXd P() const
    {
      return Eigen::MatrixXd::Identity(B.rows(), B.rows()) - G.transpose() * (G * G.transpose()).ldlt().solve(G);
    }

    Eigen::MatrixXd PFP() const
    {
      const Eigen::MatrixXd PB = P() * B;
      return PB * pseudo_inverse() * PB.transpose();
    }

    std::vector<unsigned int>   first; // unknown of every subdomain
    Eigen::MatrixXd             K, R, B, G;
    Eigen::VectorXd             f, c, e;
    std::vector<tfeti::RowKind> kind;
  };

  inline double smallest_singular_value(const Eigen::MatrixXd &A)
  {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A * A.transpose(), Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0., eigen.eigenvalues()[0] / eigen.eigenvalues().tail(1)[0]));
  }

  /// |a - b| over |b|
  inline double relative_difference(const Eigen::MatrixXd &a, const Eigen::MatrixXd &b)
  {
    return (a - b).norm() / b.norm();
  }

  // ---------------------------------------------------------------------------------------------- fields by position

  using NodalField = std::vector<std::array<double, 4>>; // x, y, u_x, u_y

  inline std::vector<Point> node_positions(const mechanics::Spaces<2> &spaces, const unsigned int p)
  {
    std::vector<Point> of_unknowns(spaces.dof_handlers[p]->n_dofs()), of_nodes;
    dealii::DoFTools::map_dofs_to_support_points(*spaces.of(p).mapping, *spaces.dof_handlers[p], of_unknowns);
    for (unsigned int i = 0; i < of_unknowns.size(); i += 2)
      of_nodes.push_back(of_unknowns[i]);
    return of_nodes;
  }

  /// All copies of all nodes of all ranks.
  inline NodalField nodal_field(const Torn &torn, const std::vector<Eigen::VectorXd> &u)
  {
    NodalField own;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        const auto x = node_positions(torn.spaces, p);
        for (unsigned int i = 0; i < x.size(); ++i)
          own.push_back({{x[i][0], x[i][1], u[p][2 * i], u[p][2 * i + 1]}});
      }
    return gathered(own, torn.comm);
  }

  inline std::array<long long, 2> position_key(const double x, const double y, const double unit)
  {
    return {{std::llround(x / unit), std::llround(y / unit)}};
  }

  /// Largest difference of nodes at the same place over the largest displacement; 1 when the places differ.
  inline double largest_difference(const NodalField &a, const NodalField &b)
  {
    double size = 0, largest = 0;
    for (const auto &node : b)
      size = std::max({size, std::abs(node[0]), std::abs(node[1])});
    std::map<std::array<long long, 2>, std::array<double, 4>> there;
    for (const auto &node : b)
      {
        there[position_key(node[0], node[1], 1e-7 * size)] = node;
        largest                                            = std::max({largest, std::abs(node[2]), std::abs(node[3])});
      }
    double                             difference = 0;
    std::set<std::array<long long, 2>> seen;
    for (const auto &node : a)
      {
        const auto key = position_key(node[0], node[1], 1e-7 * size);
        if (there.count(key) == 0)
          return 1;
        seen.insert(key);
        for (const int c : {2, 3})
          difference = std::max(difference, std::abs(node[c] - there[key][c]) / largest);
      }
    return seen.size() == there.size() ? difference : 1;
  }

  // ---------------------------------------------------------------------------------------------- untorn

  inline bool lies_on(const scene::Body<2> &body, const std::string &boundary, const Point &x)
  {
    const unsigned int d      = boundary == "left" || boundary == "right" ? 0 : 1;
    const bool         is_far = boundary == "right" || boundary == "top";
    return std::abs(x[d] - body.origin[d] - is_far * body.size[d]) < 1e-9 * body.size[d];
  }

  /// The bodies in one piece each, their supports eliminated; known to this rank alone.
  class Untorn
  {
  public:
    explicit Untorn(const Scene &scene)
      : torn(cut(scene, whole()), MPI_COMM_SELF)
    {
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        {
          positions.push_back(node_positions(torn.spaces, b));
          held.emplace_back(2 * positions[b].size(), std::nullopt);
          for (const auto &support : scene.supports)
            for (unsigned int i = 0; i < positions[b].size(); ++i)
              if (support.where.body == b && lies_on(scene.bodies[b], support.where.boundary, positions[b][i]))
                for (unsigned int c = 0; c < 2; ++c)
                  if (support.components[c])
                    held[b][2 * i + c] = support.components[c]->value(positions[b][i], 1.);
          Eigen::SparseMatrix<double> K = torn.matrices[b].stiffness.selfadjointView<Eigen::Lower>();
          for (int column = 0; column < K.outerSize(); ++column)
            for (Eigen::SparseMatrix<double>::InnerIterator entry(K, column); entry; ++entry)
              if (held[b][entry.row()] || held[b][entry.col()])
                entry.valueRef() = entry.row() == entry.col();
          factors.push_back(std::make_unique<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(K));
        }
    }

    /// Displacements of body b under forces at its nodes, with the prescribed displacements times @p with_prescribed.
    Eigen::VectorXd displacements(const unsigned int b, Eigen::VectorXd forces, const double with_prescribed) const
    {
      Eigen::VectorXd fixed = Eigen::VectorXd::Zero(forces.size());
      for (unsigned int i = 0; i < held[b].size(); ++i)
        fixed[i] = with_prescribed * held[b][i].value_or(0.);
      forces -= torn.matrices[b].stiffness.selfadjointView<Eigen::Lower>() * fixed;
      for (unsigned int i = 0; i < held[b].size(); ++i)
        if (held[b][i])
          forces[i] = fixed[i];
      return factors[b]->solve(forces);
    }

    /// Displacements under the loads of the scene.
    NodalField solution() const
    {
      std::vector<Eigen::VectorXd> u;
      for (unsigned int b = 0; b < factors.size(); ++b)
        u.push_back(displacements(b, torn.matrices[b].load, 1.));
      return nodal_field(torn, u);
    }

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
