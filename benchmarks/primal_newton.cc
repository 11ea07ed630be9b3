// benchmark_primal_newton CASE.prm [options]: the usual way to solve a contact problem with Tresca friction, to compare
// slipstick with: a primal semismooth Newton method (primal-dual active set; Hueber, Wohlmuth 2005; in space with discs: Hueber, Stadler,
// Wohlmuth 2008, in the symmetric form of converged directions) on the untorn body,
// sparse Cholesky factorisations by CHOLMOD. benchmarks/primal_newton runs it; prints one line of JSON.
//
// What makes it quick: same matrices as slipstick's (its layer of mechanics, Decomposition/Method = none), normal and tangential
// unknowns at the contact nodes, so that an active set fixes unknowns and the pattern of the matrix never changes: one
// symbolic analysis, only the entries near the contact rewritten, the factor and all workspace used again; supports are
// eliminated; the mesh is freed before the factorisation.
//
// --ordering amd|metis|nesdis   CHOLMOD's ordering
// --start open|gap|coarse       first active set: nothing closed; the node with the smallest gap (default); that of the
//                               solution on the mesh of half as many Blocks, and so on down to 1 (their time counts; in the plane)
// --condensed                   contact unknowns last in the ordering, one factorisation, Newton on their dense Schur
//                               complement: beyond the usual way (in the plane)
// --analysis-only               one analysis and one factorisation, to choose the ordering
// --tolerance EPS, --threads N (of BLAS), --openmp (CHOLMOD's OpenMP regions as they come), --set NAME=VALUE
#include <slipstick/base/log.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <Eigen/CholmodSupport>

#include <chrono>
#include <cmath>
#include <iostream>
#include <malloc.h>
#include <map>
#include <nlohmann/json.hpp>

namespace
{
  using namespace slipstick;
  using Vector = Eigen::VectorXd;

  constexpr unsigned int max_steps = 60;

  struct Options
  {
    std::string              file, ordering = "amd", start = "gap";
    bool                     condensed = false, analysis_only = false;
    double                   tolerance = 1e-4;
    int                      threads   = 1;
    bool                     openmp    = false;
    std::vector<std::string> overrides;
  };

  /// Seconds by stage; the stage entered last runs.
  class Clock
  {
  public:
    void enter(const std::string &name)
    {
      const auto now = std::chrono::steady_clock::now();
      if (!stage.empty())
        seconds[stage] += std::chrono::duration<double>(now - since).count();
      stage = name;
      since = now;
    }

    std::map<std::string, double> seconds;

  private:
    std::string                           stage;
    std::chrono::steady_clock::time_point since;
  };

  /// One contact node: unknowns v_n, v_t of the reduced problem, u = n v_n + t v_t.
  template <int dim>
  struct ContactNode
  {
    std::array<int, dim> unknown;                    // normal, tangential
    double               position, area, gap, bound; // along x [mm], [mm^2], [mm], [N]
  };

  /// min 1/2 v'A v - b'v + sum bound |v_t|, v_n <= gap, supports eliminated.
  template <int dim>
  struct Problem
  {
    Eigen::SparseMatrix<double>   lower; // lower triangle of A [N/mm]
    Vector                        load;  // [N]
    std::vector<ContactNode<dim>> nodes; // sorted by position
  };

  /// Normal and tangential directions in place of x and y at the contact nodes: A := Q'A Q on their blocks.
  template <int dim>
  void rotate(Eigen::SparseMatrix<double>                          &A,
              Vector                                               &b,
              const std::map<int, Eigen::Matrix<double, dim, dim>> &directions)
  {
    using Square     = Eigen::Matrix<double, dim, dim>;
    const auto entry = [&A](const int i, const int j) -> double & {
      const int *begin = A.innerIndexPtr() + A.outerIndexPtr()[j], *end = A.innerIndexPtr() + A.outerIndexPtr()[j + 1];
      return A.valuePtr()[std::lower_bound(begin, end, i) - A.innerIndexPtr()];
    };
    const auto direction = [&directions](const int node) -> Square {
      const auto found = directions.find(node);
      return found == directions.end() ? Square(Square::Identity()) : found->second;
    };
    for (int column = 0; dim * column < A.cols(); ++column)
      for (int k = A.outerIndexPtr()[dim * column]; k < A.outerIndexPtr()[dim * column + 1]; ++k)
        {
          const int row = A.innerIndexPtr()[k] / dim;
          if (A.innerIndexPtr()[k] % dim != 0 || (!directions.count(row) && !directions.count(column)))
            continue;
          Square block;
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              block(i, j) = row == column && i < j ? entry(dim * row + j, dim * column + i)
                                                   : entry(dim * row + i, dim * column + j);
          block = direction(row).transpose() * block * direction(column);
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              if (row != column || i >= j)
                entry(dim * row + i, dim * column + j) = block(i, j);
        }
    for (const auto &[node, Q] : directions)
      b.segment<dim>(dim * node) = Q.transpose() * b.segment<dim>(dim * node).eval();
  }

  /// Removes rows and columns; in place, since indices only move down. Returns the new numbers, -1 for removed ones.
  std::vector<int> eliminate(Eigen::SparseMatrix<double> &A, Vector &b, const std::vector<bool> &held)
  {
    std::vector<int> number(A.cols(), -1);
    int              n = 0, kept = 0;
    for (int i = 0; i < A.cols(); ++i)
      if (!held[i])
        number[i] = n++;
    int begin = 0;
    for (int j = 0; j < A.cols(); ++j)
      {
        const int end = A.outerIndexPtr()[j + 1];
        if (!held[j])
          {
            for (int k = begin; k < end; ++k)
              if (const int i = A.innerIndexPtr()[k]; !held[i])
                {
                  A.innerIndexPtr()[kept] = number[i];
                  A.valuePtr()[kept++]    = A.valuePtr()[k];
                }
            b[number[j]]                     = b[j];
            A.outerIndexPtr()[number[j] + 1] = kept;
          }
        begin = end;
      }
    b.conservativeResize(n);
    Eigen::SparseMatrix<double> reduced =
      Eigen::Map<Eigen::SparseMatrix<double>>(n, n, kept, A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr());
    A.swap(reduced);
    return number;
  }

  template <int dim>
  Problem<dim> assembled(const Options &options, const std::vector<std::string> &overrides, Clock &clock)
  {
    clock.enter("mesh");
    const auto scene       = scene::read_scene<dim>(options.file, overrides);
    const auto mesh        = std::make_unique<const mesh::Mesh<dim>>(mesh::make_mesh(scene, MPI_COMM_WORLD));
    const auto spaces      = std::make_unique<const mechanics::Spaces<dim>>(*mesh, scene.discretization.degree);
    const auto constraints = interface::contact_constraints(scene, *mesh, *spaces, 1.);
    clock.enter("assembly");
    auto matrices = mechanics::assemble(scene, *mesh, *spaces, 1.);
    if (matrices.size() != 1)
      throw std::runtime_error("one body and one rank, please");

    Problem<dim> problem;
    problem.lower = std::move(matrices[0].stiffness);
    problem.load  = std::move(matrices[0].load);
    std::vector<bool>                                   held(problem.load.size(), false);
    std::vector<std::vector<tfeti::Constraints::Entry>> entries(constraints.kind.size());
    for (const auto &entry : constraints.blocks[0])
      entries[entry.row].push_back(entry);
    for (unsigned int row = 0; row < entries.size(); ++row)
      if (constraints.kind[row] == tfeti::RowKind::prescribed)
        {
          if (entries[row].size() != 1 || constraints.c[row] != 0)
            throw std::runtime_error("supports must hold single unknowns at 0 here");
          held[entries[row][0].dof] = true;
        }
    using Square = Eigen::Matrix<double, dim, dim>;
    std::map<int, Square> directions;
    for (const auto &point : constraints.contact_points)
      {
        const int first = entries[point.normal_row][0].dof / dim * dim;
        if (std::all_of(held.begin() + first, held.begin() + first + dim, [](const bool is_held) { return is_held; }))
          continue;
        ContactNode<dim>                  node;
        Square                            Q    = Square::Zero();
        const std::array<unsigned int, 3> rows = {{point.normal_row, point.tangential_row, point.second_row}};
        for (int k = 0; k < dim; ++k)
          for (const auto &entry : entries[rows[k]])
            Q(entry.dof - first, k) = entry.value;
        if (!(Q.transpose() * Q).isIdentity(1e-10))
          throw std::runtime_error("contact rows are not orthonormal");
        directions[first / dim] = Q;
        for (int k = 0; k < dim; ++k)
          node.unknown[k] = first + k;
        node.position           = point.position[0];
        node.area               = point.area;
        node.gap                = constraints.c[point.normal_row];
        const auto        &pair = scene.contacts[point.pair];
        dealii::Point<dim> x;
        for (int k = 0; k < dim; ++k)
          x[k] = point.position[k];
        node.bound = pair.law.admissible_forces(x, 1., point.area, pair.name).fixed;
        problem.nodes.push_back(node);
      }
    rotate<dim>(problem.lower, problem.load, directions);
    const auto number = eliminate(problem.lower, problem.load, held);
    for (auto &node : problem.nodes)
      for (int &unknown : node.unknown)
        unknown = number[unknown];
    std::sort(problem.nodes.begin(), problem.nodes.end(), [](const auto &a, const auto &b) {
      return a.position < b.position;
    });
    return problem;
  }

  /// Mesh and spaces are gone, and their memory is given back.
  template <int dim>
  Problem<dim> make_problem(const Options &options, const std::vector<std::string> &overrides, Clock &clock)
  {
    Problem<dim> problem = assembled<dim>(options, overrides, clock);
    malloc_trim(0);
    return problem;
  }

  enum class Normal : signed char
  {
    open,
    closed
  };

  /// What is assumed of the tangential motion: none, or the friction bound * direction + stiffness * (what of v_t is across it).
  template <int dim>
  struct Slip
  {
    bool                              slips     = false;
    Eigen::Matrix<double, dim - 1, 1> direction = Eigen::Matrix<double, dim - 1, 1>::Zero(); // of v_t, length 1
    double                            stiffness = 0;                                         // [N/mm]

    /// In the plane alone sets come back to the last bit.
    bool operator==(const Slip &other) const
    {
      return slips == other.slips && direction == other.direction && stiffness == other.stiffness;
    }
  };

  /// What is assumed of every contact node in a Newton step.
  template <int dim>
  struct ActiveSet
  {
    std::vector<Normal>    normal;
    std::vector<Slip<dim>> slip;

    bool operator==(const ActiveSet &other) const
    {
      return normal == other.normal && slip == other.slip;
    }
  };

  /// v and the forces at contact unknowns.
  template <int dim>
  struct State
  {
    using Node = Eigen::Matrix<double, dim, 1>;
    std::vector<Node> v, force; // [mm]; -(A v - b) [N]
  };

  /// w = force + constant v_t tells the next slip: force = bound w / |w|, linearised where w is, with the converged direction on its own
  /// side, so that the matrix stays symmetric. In the plane nothing is across the direction.
  template <int dim>
  Slip<dim> slip_along(const Eigen::Matrix<double, dim - 1, 1> &w, const double bound, const double constant)
  {
    Slip<dim> slip;
    slip.slips     = true;
    slip.direction = w.normalized();
    if (dim == 3)
      slip.stiffness = constant * bound / std::max(w.norm() - bound, 1e-12 * w.norm());
    return slip;
  }

  /// The next active set, and how far the state is from complementarity: violated forces over all forces, violated
  /// displacements over all displacements, the larger. A node that slips against its friction sticks next: the constant
  /// of the complementarity function is taken so small that it never reverses at once (with 1e5 N/mm it cycles).
  template <int dim>
  std::pair<ActiveSet<dim>, double> next_set(const Problem<dim>   &problem,
                                             const State<dim>     &state,
                                             const ActiveSet<dim> &set,
                                             const double          constant = 0)
  {
    ActiveSet<dim> next        = set;
    double         wrong_force = 0, wrong_motion = 0, force = 0, motion = 0;
    const auto     square = [](const double x) { return x * x; };
    for (unsigned int i = 0; i < problem.nodes.size(); ++i)
      {
        const auto  &node = problem.nodes[i];
        const double v_n = state.v[i][0], force_n = state.force[i][0];
        const auto   v_t     = state.v[i].template tail<dim - 1>().eval();
        const auto   force_t = state.force[i].template tail<dim - 1>().eval();
        const bool   closed  = set.normal[i] == Normal::closed;
        force += state.force[i].squaredNorm();
        motion += state.v[i].squaredNorm();
        (closed ? wrong_force : wrong_motion) += square(closed ? std::min(force_n, 0.) : std::max(v_n - node.gap, 0.));
        next.normal[i] = (closed ? force_n > 0 : v_n > node.gap) ? Normal::closed : Normal::open;
        if (!set.slip[i].slips)
          {
            wrong_force += square(std::max(force_t.norm() - node.bound, 0.));
            if (force_t.norm() > node.bound)
              next.slip[i] = slip_along<dim>(force_t, node.bound, constant);
          }
        else if (set.slip[i].direction.dot(v_t) < 0)
          {
            wrong_motion += v_t.squaredNorm();
            next.slip[i] = {};
          }
        else if (dim == 3)
          {
            if (v_t.norm() > 0)
              wrong_force += (force_t - node.bound * v_t.normalized()).squaredNorm();
            next.slip[i] = slip_along<dim>(force_t + constant * v_t, node.bound, constant);
          }
      }
    return {next,
            std::max(std::sqrt(wrong_force / std::max(force, 1e-300)),
                     std::sqrt(wrong_motion / std::max(motion, 1e-300)))};
  }

  /// CHOLMOD behind one matrix of constant pattern.
  class Factor
  {
  public:
    Factor(Eigen::SparseMatrix<double> &lower, const std::string &ordering)
    {
      cholmod_start(&common);
      common.supernodal = CHOLMOD_SUPERNODAL;
      common.final_ll   = 1;
      common.nmethods   = 1;
      common.method[0].ordering =
        ordering == "metis" ? CHOLMOD_METIS : (ordering == "nesdis" ? CHOLMOD_NESDIS : CHOLMOD_AMD);
      A      = Eigen::viewAsCholmod(std::as_const(lower).selfadjointView<Eigen::Lower>());
      factor = cholmod_analyze(&A, &common);
      check();
    }

    /// With the unknowns @p last ordered last, CHOLMOD's METIS ordering of the others.
    Factor(Eigen::SparseMatrix<double> &lower, const std::vector<int> &last)
    {
      cholmod_start(&common);
      common.supernodal         = CHOLMOD_SUPERNODAL;
      common.final_ll           = 1;
      common.nmethods           = 1;
      common.method[0].ordering = CHOLMOD_GIVEN;
      common.postorder          = 0;
      A                         = Eigen::viewAsCholmod(std::as_const(lower).selfadjointView<Eigen::Lower>());
      std::vector<bool> is_last(lower.cols(), false);
      for (const int i : last)
        is_last[i] = true;
      std::vector<int> others, permutation(lower.cols());
      for (int i = 0; i < lower.cols(); ++i)
        if (!is_last[i])
          others.push_back(i);
      cholmod_sparse *whole = cholmod_copy(&A, 0, 0, &common); // both triangles
      cholmod_sparse *interior =
        cholmod_submatrix(whole, others.data(), others.size(), others.data(), others.size(), 0, 1, &common);
      cholmod_free_sparse(&whole, &common);
      interior->stype                = -1;
      cholmod_sparse *interior_lower = cholmod_copy(interior, -1, 0, &common);
      cholmod_free_sparse(&interior, &common);
      std::vector<int> inner(others.size());
      cholmod_metis(interior_lower, nullptr, 0, 1, inner.data(), &common);
      cholmod_free_sparse(&interior_lower, &common);
      for (std::size_t i = 0; i < inner.size(); ++i)
        permutation[i] = others[inner[i]];
      std::copy(last.begin(), last.end(), permutation.begin() + inner.size());
      factor = cholmod_analyze_p(&A, permutation.data(), nullptr, 0, &common);
      check();
    }

    ~Factor()
    {
      for (cholmod_dense **dense : {&x, &y, &e})
        cholmod_free_dense(dense, &common);
      cholmod_free_factor(&factor, &common);
      cholmod_finish(&common);
    }

    Factor(const Factor &)            = delete;
    Factor &operator=(const Factor &) = delete;

    void factorise()
    {
      cholmod_factorize(&A, factor, &common);
      check();
    }

    /// The solution lives until the next call.
    const double *solve(Vector &b)
    {
      cholmod_dense right{};
      right.nrow = right.d = right.nzmax = b.size();
      right.ncol                         = 1;
      right.x                            = b.data();
      right.xtype                        = CHOLMOD_REAL;
      right.dtype                        = CHOLMOD_DOUBLE;
      cholmod_solve2(CHOLMOD_A, factor, &right, nullptr, &x, nullptr, &y, &e, &common);
      check();
      return static_cast<const double *>(x->x);
    }

    double megabytes() const
    {
      return 8e-6 * factor->xsize;
    }

    /// The last n x n entries of L, lower triangle.
    Eigen::MatrixXd trailing(const int n) const
    {
      const int   first  = static_cast<int>(factor->n) - n;
      const auto *super  = static_cast<const int *>(factor->super);
      const auto *pi     = static_cast<const int *>(factor->pi);
      const auto *px     = static_cast<const int *>(factor->px);
      const auto *rows   = static_cast<const int *>(factor->s);
      const auto *values = static_cast<const double *>(factor->x);

      Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n, n);
      for (int s = 0; s < static_cast<int>(factor->nsuper); ++s)
        for (int column = std::max(super[s], first); column < super[s + 1]; ++column)
          for (int k = column - super[s], height = pi[s + 1] - pi[s]; k < height; ++k)
            block(rows[pi[s] + k] - first, column - first) =
              values[px[s] + std::ptrdiff_t(column - super[s]) * height + k];
      return block;
    }

  private:
    void check() const
    {
      if (common.status != CHOLMOD_OK)
        throw std::runtime_error("CHOLMOD status " + std::to_string(common.status));
    }

    cholmod_common  common;
    cholmod_sparse  A{};
    cholmod_factor *factor = nullptr;
    cholmod_dense  *x = nullptr, *y = nullptr, *e = nullptr;
  };

  /// The matrix of a Newton step: entries near the contact are those of A or of fixed unknowns.
  template <int dim>
  class ContactEntries
  {
  public:
    ContactEntries(Problem<dim> &problem_)
      : problem(problem_)
      , node_of(problem_.load.size(), -1)
      , component_of(problem_.load.size(), 0)
    {
      for (unsigned int i = 0; i < problem.nodes.size(); ++i)
        for (int k = 0; k < dim; ++k)
          {
            node_of[problem.nodes[i].unknown[k]]      = i;
            component_of[problem.nodes[i].unknown[k]] = k;
          }
      auto &A = problem.lower;
      for (int j = 0; j < A.cols(); ++j)
        for (int k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k)
          if (const int i = A.innerIndexPtr()[k]; node_of[i] >= 0 || node_of[j] >= 0)
            entries.push_back({k, i, j, A.valuePtr()[k]});
    }

    /// Writes the matrix of a step into the lower triangle of the problem; returns its right hand side.
    Vector matrix_and_load(const ActiveSet<dim> &set)
    {
      std::vector<char> fixed(problem.load.size(), 0);
      Vector            b = problem.load, value = Vector::Zero(problem.load.size());
      for (unsigned int i = 0; i < problem.nodes.size(); ++i)
        {
          const auto &unknown = problem.nodes[i].unknown;
          fixed[unknown[0]]   = set.normal[i] == Normal::closed;
          value[unknown[0]]   = problem.nodes[i].gap;
          for (int k = 1; k < dim; ++k)
            {
              fixed[unknown[k]] = !set.slip[i].slips;
              b[unknown[k]] -= set.slip[i].direction[k - 1] * problem.nodes[i].bound;
            }
        }
      for (const auto &[k, i, j, a] : entries)
        {
          problem.lower.valuePtr()[k] = !fixed[i] && !fixed[j] ? a + friction(set, i, j) : (i == j ? a : 0.);
          if (i != j && fixed[i] && !fixed[j])
            b[j] -= a * value[i];
          if (i != j && fixed[j] && !fixed[i])
            b[i] -= a * value[j];
        }
      for (const auto &[k, i, j, a] : entries)
        if (i == j && fixed[i])
          b[i] = a * value[i];
      return b;
    }

    State<dim> state(const double *v) const
    {
      using Node = typename State<dim>::Node;
      State<dim>        state;
      std::vector<Node> product(problem.nodes.size(), Node::Zero());
      const auto        add = [&](const int i, const double x) {
        if (node_of[i] >= 0)
          product[node_of[i]][component_of[i]] += x;
      };
      for (const auto &[k, i, j, a] : entries)
        {
          add(i, a * v[j]);
          if (i != j)
            add(j, a * v[i]);
        }
      for (unsigned int i = 0; i < problem.nodes.size(); ++i)
        {
          state.v.push_back(Node::Zero());
          state.force.push_back(-product[i]);
          for (int k = 0; k < dim; ++k)
            {
              state.v.back()[k] = v[problem.nodes[i].unknown[k]];
              state.force.back()[k] += problem.load[problem.nodes[i].unknown[k]];
            }
        }
      return state;
    }

    /// Mean stiffness of the tangential unknowns [N/mm].
    double mean_stiffness() const
    {
      double       sum = 0;
      unsigned int n   = 0;
      for (const auto &[k, i, j, a] : entries)
        if (i == j && component_of[i] > 0)
          {
            sum += a;
            ++n;
          }
      return sum / std::max(n, 1u);
    }

  private:
    /// What friction adds to an entry.
    double friction(const ActiveSet<dim> &set, const int i, const int j) const
    {
      if (dim == 2 || node_of[i] != node_of[j] || component_of[i] == 0 || component_of[j] == 0)
        return 0;
      const Slip<dim> &slip = set.slip[node_of[i]];
      return slip.stiffness * ((i == j) - slip.direction[component_of[i] - 1] * slip.direction[component_of[j] - 1]);
    }

    struct Entry
    {
      int    place, i, j;
      double value;
    };

    Problem<dim>      &problem;
    std::vector<int>   node_of, component_of; // by unknown
    std::vector<Entry> entries;
  };

  template <int dim>
  struct Result
  {
    ActiveSet<dim> set;
    State<dim>     state;
    Vector         v;
    unsigned int   steps     = 0;
    double         violation = 0, factor_mb = 0;
    bool           converged = false;
  };

  /// Newton with a factorisation a step.
  template <int dim>
  Result<dim> newton(Problem<dim> &problem, const ActiveSet<dim> &start, const Options &options, Clock &clock)
  {
    clock.enter("assembly");
    ContactEntries<dim> contact(problem);
    const double        constant = contact.mean_stiffness();
    Result<dim>         result;
    result.set = start;
    clock.enter("analysis");
    Factor factor(problem.lower, options.ordering);
    while (result.steps < max_steps && !result.converged)
      {
        clock.enter("factorization");
        Vector b = contact.matrix_and_load(result.set);
        factor.factorise();
        ++result.steps;
        if (options.analysis_only)
          break;
        clock.enter("solve");
        const double *v        = factor.solve(b);
        result.state           = contact.state(v);
        auto [next, violation] = next_set(problem, result.state, result.set, constant);
        result.violation       = violation;
        result.converged       = violation <= options.tolerance || next == result.set;
        if (result.converged)
          result.v = Eigen::Map<const Vector>(v, b.size());
        else
          result.set = std::move(next);
      }
    result.factor_mb = factor.megabytes();
    return result;
  }

  /// Newton on the Schur complement of the contact unknowns; one sparse factorisation in all.
  Result<2> condensed(Problem<2> &problem, const ActiveSet<2> &start, const Options &options, Clock &clock)
  {
    std::vector<int> last;
    for (const auto &node : problem.nodes)
      last.insert(last.end(), node.unknown.begin(), node.unknown.end());
    clock.enter("analysis");
    Factor factor(problem.lower, last);
    clock.enter("factorization");
    factor.factorise();
    clock.enter("solve");
    const int             n = last.size();
    const Eigen::MatrixXd L = factor.trailing(n), S = L * L.transpose();
    Vector                b = problem.load;
    const double         *u = factor.solve(b);
    Vector                u_last(n);
    for (int k = 0; k < n; ++k)
      u_last[k] = u[last[k]];
    const Vector g = S * u_last; // condensed load
    Result<2>    result;
    result.set       = start;
    result.factor_mb = factor.megabytes();
    Vector v(n), force(n);
    while (result.steps < max_steps && !result.converged)
      {
        ++result.steps;
        std::vector<int> free;
        Vector           right = g;
        v.setZero();
        for (int i = 0; i < n / 2; ++i)
          {
            if (result.set.normal[i] == Normal::open)
              free.push_back(2 * i);
            else
              v[2 * i] = problem.nodes[i].gap;
            if (result.set.slip[i].slips)
              {
                free.push_back(2 * i + 1);
                right[2 * i + 1] -= result.set.slip[i].direction[0] * problem.nodes[i].bound;
              }
          }
        right -= S * v;
        if (!free.empty())
          {
            const Eigen::MatrixXd part     = S(free, free);
            const Vector          solution = part.llt().solve(Vector(right(free)));
            v(free)                        = solution;
          }
        force        = g - S * v;
        result.state = State<2>();
        for (int i = 0; i < n / 2; ++i)
          {
            result.state.v.push_back(v.segment<2>(2 * i));
            result.state.force.push_back(force.segment<2>(2 * i));
          }
        auto [next, violation] = next_set(problem, result.state, result.set);
        result.violation       = violation;
        result.converged       = violation <= options.tolerance || next == result.set;
        if (!result.converged)
          result.set = std::move(next);
      }
    for (int k = 0; k < n; ++k)
      b[last[k]] -= force[k];
    result.v = Eigen::Map<const Vector>(factor.solve(b), b.size());
    return result;
  }

  template <int dim>
  ActiveSet<dim> first_set(const Problem<dim> &problem, const std::string &start)
  {
    ActiveSet<dim> set{std::vector<Normal>(problem.nodes.size(), Normal::open),
                       std::vector<Slip<dim>>(problem.nodes.size())};
    double         smallest = HUGE_VAL;
    for (const auto &node : problem.nodes)
      smallest = std::min(smallest, node.gap);
    if (start == "gap")
      for (unsigned int i = 0; i < problem.nodes.size(); ++i)
        if (problem.nodes[i].gap <= smallest + 1e-9)
          set.normal[i] = Normal::closed;
    return set;
  }

  /// The active set of the nearest node of a coarser mesh.
  template <int dim>
  ActiveSet<dim> transferred(const Problem<dim> &from, const ActiveSet<dim> &set, const Problem<dim> &to)
  {
    ActiveSet<dim> result = first_set(to, "open");
    unsigned int   k      = 0;
    for (unsigned int i = 0; i < to.nodes.size(); ++i)
      {
        while (k + 1 < from.nodes.size() && std::abs(from.nodes[k + 1].position - to.nodes[i].position) <=
                                              std::abs(from.nodes[k].position - to.nodes[i].position))
          ++k;
        result.normal[i] = set.normal[k];
        result.slip[i]   = set.slip[k];
      }
    return result;
  }

  template <int dim>
  Result<dim> solve(Problem<dim> &problem, const ActiveSet<dim> &start, const Options &options, Clock &clock)
  {
    if constexpr (dim == 2)
      if (options.condensed)
        return condensed(problem, start, options, clock);
    return newton(problem, start, options, clock);
  }

  std::vector<std::string> with_blocks(std::vector<std::string> overrides, const unsigned int blocks)
  {
    overrides.push_back("Decomposition/Method=none");
    overrides.push_back("Decomposition/Blocks=" + std::to_string(blocks));
    return overrides;
  }

  template <int dim>
  nlohmann::json run(const Options &options)
  {
    if (dim == 3 && (options.condensed || options.start == "coarse"))
      throw std::runtime_error("--condensed and --start coarse are for scenes in the plane");
    Clock clock;
    clock.enter("mesh");
    const unsigned int        blocks = scene::read_scene<dim>(options.file, options.overrides).decomposition.blocks;
    std::vector<unsigned int> steps_before;
    ActiveSet<dim>            start;
    Problem<dim>              coarse;
    if (options.start == "coarse")
      for (unsigned int n = 1; n < blocks; n *= 2)
        {
          Problem<dim> finer = make_problem<dim>(options, with_blocks(options.overrides, n), clock);
          start              = n == 1 ? first_set(finer, "open") : transferred(coarse, start, finer);
          auto result        = solve(finer, start, options, clock);
          steps_before.push_back(result.steps);
          start        = std::move(result.set);
          coarse.nodes = finer.nodes;
        }
    Problem<dim> problem = make_problem<dim>(options, with_blocks(options.overrides, blocks), clock);
    start = coarse.nodes.empty() ? first_set(problem, options.start) : transferred(coarse, start, problem);
    const Result<dim> result = solve(problem, start, options, clock);
    clock.enter("end");

    nlohmann::json out;
    double         total = 0;
    for (const auto &[stage, seconds] : clock.seconds)
      {
        out["time_s"][stage] = seconds;
        total += seconds;
      }
    out["time_s"]["total"] = total;
    out["unknowns"]        = problem.load.size();
    out["steps"]           = result.steps;
    out["steps_before"]    = steps_before;
    out["factor_mb"]       = result.factor_mb;
    out["memory_mb"]       = peak_memory_mb();
    if (options.analysis_only)
      return out;
    double       largest_pressure = 0, normal_force = 0, tangential_force = 0, displacement = 0;
    unsigned int closed = 0, slips = 0;
    for (unsigned int i = 0; i < problem.nodes.size(); ++i)
      {
        closed += result.set.normal[i] == Normal::closed;
        slips += result.set.slip[i].slips;
        largest_pressure = std::max(largest_pressure, result.state.force[i][0] / problem.nodes[i].area);
        normal_force += result.state.force[i][0];
        tangential_force += dim == 2 ? result.state.force[i][1] : result.state.force[i].tail(dim - 1).norm();
      }
    for (int i = 0; i + dim <= result.v.size(); i += dim)
      displacement = std::max(displacement, result.v.template segment<dim>(i).norm());
    out["converged"]        = result.converged;
    out["violation"]        = result.violation;
    out["contact_nodes"]    = closed;
    out["slip_nodes"]       = slips;
    out["max_pressure"]     = largest_pressure;
    out["normal_force"]     = normal_force;
    out["tangential_force"] = tangential_force;
    out["max_displacement"] = displacement;
    return out;
  }

  Options read(const int argc, char **argv)
  {
    Options options;
    for (int i = 1; i < argc; ++i)
      {
        const std::string word = argv[i];
        const auto        next = [&]() -> std::string {
          if (i + 1 == argc)
            throw std::runtime_error(word + " takes a value");
          return argv[++i];
        };
        if (word == "--ordering")
          options.ordering = next();
        else if (word == "--start")
          options.start = next();
        else if (word == "--condensed")
          options.condensed = true;
        else if (word == "--analysis-only")
          options.analysis_only = true;
        else if (word == "--tolerance")
          options.tolerance = std::stod(next());
        else if (word == "--threads")
          options.threads = std::stoi(next());
        else if (word == "--openmp")
          options.openmp = true;
        else if (word == "--set")
          options.overrides.push_back(next());
        else
          options.file = word;
      }
    if (options.file.empty())
      throw std::runtime_error("usage: benchmark_primal_newton CASE.prm [options], see the head of its source");
    return options;
  }
} // namespace

int main(int argc, char **argv)
{
  try
    {
      const Options  options = read(argc, argv);
      tfeti::Process process(options.threads, options.openmp);
      const bool     is_solid = scene::read_dimension(options.file, options.overrides) == 3;
      std::cout << (is_solid ? run<3>(options) : run<2>(options)).dump() << std::endl;
    }
  catch (const std::exception &error)
    {
      std::cerr << "benchmark_primal_newton: " << error.what() << std::endl;
      return 1;
    }
  return 0;
}
