#include "torn.h"

#include <deal.II/dofs/dof_tools.h>

#include <set>

namespace slipstick::test
{
  scene::Field<2> field(const std::string &formula)
  {
    return scene::Field<2>(formula, "test");
  }

  Cut whole()
  {
    return {scene::DecompositionMethod::none, 1};
  }

  Cut blocks(const unsigned int n)
  {
    return {scene::DecompositionMethod::blocks, n};
  }

  Cut metis(const unsigned int n)
  {
    return {scene::DecompositionMethod::metis, n};
  }

  Scene cut(Scene scene, const Cut &how)
  {
    scene.decomposition.method     = how.method;
    scene.decomposition.blocks     = how.n;
    scene.decomposition.subdomains = how.n;
    return scene;
  }

  void add_body(Scene                             &scene,
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

  void support(Scene             &scene,
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

  void touch(Scene                      &scene,
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

  void load(Scene             &scene,
            const unsigned int body,
            const std::string &boundary,
            const std::string &x,
            const std::string &y)
  {
    scene.tractions.push_back({"load on " + boundary, {body, boundary}, {{field(x), field(y)}}, {}});
  }

  void touch(Scene             &scene,
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

  Scene box(const unsigned int n, const unsigned int degree)
  {
    Scene scene                 = cut(Scene(), whole());
    scene.discretization.degree = degree;
    add_body(scene, "box", {0, 0}, {10, 10}, {{n, n}});
    return scene;
  }

  Scene bent_box(const unsigned int n, const unsigned int degree)
  {
    Scene scene               = box(n, degree);
    scene.bodies[0].thickness = 2;
    support(scene, 0, "left", "1e-3*y", "2e-3");
    support(scene, 0, "bottom", "", "2e-3 - 1e-5*x*x");
    load(scene, 0, "top", "10*x", "-250*sin(x)");
    load(scene, 0, "right", "30-y^2", "7*y");
    return scene;
  }

  Scene box_on_circle(const unsigned int n, const std::string &slip_bound, const unsigned int degree)
  {
    Scene scene = box(n, degree);
    support(scene, 0, "left", "0", "0");
    load(scene, 0, "top", "0", "-250");
    touch(scene, 0, "bottom", {5, -20}, 20, slip_bound);
    return scene;
  }

  Scene two_bodies(const unsigned int n)
  {
    Scene scene = bent_box(n);
    add_body(scene, "beam", {20, 3}, {12, 4}, {{2 * n, n}});
    scene.materials[1].young_modulus = 7e4;
    support(scene, 1, "right", "0", "0");
    load(scene, 1, "left", "5", "20");
    return scene;
  }

  std::vector<std::string> body_names(const Scene &scene)
  {
    std::vector<std::string> names;
    for (const auto &body : scene.bodies)
      names.push_back(body.name);
    return names;
  }

  Eigen::VectorXd gathered(const tfeti::DistributedVector &x, const MPI_Comm comm)
  {
    const auto all = gathered(std::vector<double>(x.begin(), x.end()), comm);
    return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
  }

  tfeti::DistributedVector distributed(const Eigen::VectorXd &x, const tfeti::DualProblem &dual)
  {
    tfeti::DistributedVector part  = dual.zero();
    const auto               first = part.get_partitioner()->local_range().first;
    for (unsigned int r = 0; r < part.locally_owned_size(); ++r)
      part.local_element(r) = x[first + r];
    return part;
  }

  Eigen::VectorXd random_vector(const unsigned int n, const unsigned int seed)
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

  Eigen::MatrixXd moore_penrose(const Eigen::MatrixXd &A)
  {
    const tfeti::SymmetricEigen eigen(A);
    Eigen::VectorXd      inverse = eigen.values;
    for (double &value : inverse)
      value = value > 1e-11 * eigen.values.tail(1)[0] ? 1 / value : 0.;
    return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
  }

  Eigen::MatrixXd full(const Eigen::SparseMatrix<double> &lower)
  {
    const Eigen::MatrixXd dense = lower;
    return dense.selfadjointView<Eigen::Lower>();
  }

  double smallest_singular_value(const Eigen::MatrixXd &A)
  {
    const Eigen::VectorXd values = tfeti::symmetric_eigenvalues(A * A.transpose());
    return std::sqrt(std::max(0., values[0] / values.tail(1)[0]));
  }

  double relative_difference(const Eigen::MatrixXd &a, const Eigen::MatrixXd &b)
  {
    return (a - b).norm() / b.norm();
  }

  std::vector<Point> node_positions(const mechanics::Spaces<2> &spaces, const unsigned int p)
  {
    std::vector<Point> of_unknowns(spaces.dof_handlers[p]->n_dofs()), of_nodes;
    dealii::DoFTools::map_dofs_to_support_points(*spaces.of(p).mapping, *spaces.dof_handlers[p], of_unknowns);
    for (unsigned int i = 0; i < of_unknowns.size(); i += 2)
      of_nodes.push_back(of_unknowns[i]);
    return of_nodes;
  }

  NodalField nodal_field(const Torn &torn, const std::vector<Eigen::VectorXd> &u)
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

  std::array<long long, 2> position_key(const double x, const double y, const double unit)
  {
    return {{std::llround(x / unit), std::llround(y / unit)}};
  }

  double largest_difference(const NodalField &a, const NodalField &b)
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

  bool lies_on(const scene::Body<2> &body, const std::string &boundary, const Point &x)
  {
    const unsigned int d      = boundary == "left" || boundary == "right" ? 0 : 1;
    const bool         is_far = boundary == "right" || boundary == "top";
    return std::abs(x[d] - body.origin[d] - is_far * body.size[d]) < 1e-9 * body.size[d];
  }

  Torn::Torn(const Scene &scene_, const MPI_Comm comm_, const double t)
    : scene(scene_)
    , comm(comm_)
    , mesh(mesh::make_mesh(scene, comm))
    , spaces(mesh, scene.discretization.degree)
    , matrices(mechanics::assemble(scene, mesh, spaces, t))
    , constraints(interface::contact_constraints(scene, mesh, spaces, t))
  {}

  std::unique_ptr<tfeti::DualProblem> Torn::dual(const tfeti::DualOptions &options) const
  {
    return std::make_unique<tfeti::DualProblem>(matrices, constraints, options, body_names(scene), comm);
  }

  std::unique_ptr<tfeti::DualProblem> Torn::dual() const
  {
    return dual(scene.solver.dual);
  }

  Dense::Dense(const Torn &torn)
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

  Eigen::MatrixXd Dense::pseudo_inverse() const
  {
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(K.rows(), K.cols());
    for (unsigned int s = 0; s + 1 < first.size(); ++s)
      {
        const unsigned int n                    = first[s + 1] - first[s];
        inverse.block(first[s], first[s], n, n) = moore_penrose(K.block(first[s], first[s], n, n));
      }
    return inverse;
  }

  Eigen::MatrixXd Dense::P() const
  {
    return Eigen::MatrixXd::Identity(B.rows(), B.rows()) - G.transpose() * (G * G.transpose()).ldlt().solve(G);
  }

  Eigen::MatrixXd Dense::PFP() const
  {
    const Eigen::MatrixXd PB = P() * B;
    return PB * pseudo_inverse() * PB.transpose();
  }

  Untorn::Untorn(const Scene &scene)
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

  Eigen::VectorXd Untorn::displacements(const unsigned int b,
                                        Eigen::VectorXd    forces,
                                        const double       with_prescribed) const
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

  NodalField Untorn::solution() const
  {
    std::vector<Eigen::VectorXd> u;
    for (unsigned int b = 0; b < factors.size(); ++b)
      u.push_back(displacements(b, torn.matrices[b].load, 1.));
    return nodal_field(torn, u);
  }
} // namespace slipstick::test
