// What master and slave cannot represent of contact tractions: closed forms for an edge that is loaded on a quarter.
#include "torn.h"

#include <slipstick/interface/transfer_defect.h>

using namespace slipstick;

namespace
{
  /// A unit square or cube, and a body of one cell on a quarter of its top.
  /// @param is_resolved whether that quarter ends at nodes
  template <int dim>
  scene::Scene<dim> quarter(const unsigned int degree, const bool is_resolved)
  {
    scene::Scene<dim> scene;
    scene.discretization.degree = degree;
    scene.decomposition.method  = scene::DecompositionMethod::none;
    scene.materials.emplace_back();
    for (const char *name : {"low", "up"})
      {
        scene.bodies.emplace_back();
        auto &body = scene.bodies.back();
        body.name  = name;
        body.cells.emplace();
        for (unsigned int d = 0; d < dim; ++d)
          {
            body.size[d]     = 1;
            (*body.cells)[d] = 1;
          }
      }
    auto &up     = scene.bodies[1];
    up.size[0]   = 0.25;
    up.origin[1] = 1;
    if (is_resolved)
      (*scene.bodies[0].cells)[0] = 4;
    scene.contacts.emplace_back();
    scene.contacts[0].slave  = {1, "bottom"};
    scene.contacts[0].master = scene::BoundaryName{0, "top"};
    return scene;
  }

  /// Of a uniform traction of 1, over both sides.
  template <int dim>
  double rest_of_uniform(const scene::Scene<dim> &scene, const bool in_tetrahedra = false)
  {
    mesh::Refinement             refinement;
    const auto                   mesh = mesh::make_mesh(scene, MPI_COMM_WORLD, in_tetrahedra ? &refinement : nullptr);
    const mechanics::Spaces<dim> spaces(mesh, scene.discretization.degree);
    const auto                   all = mechanics::outlines(mesh, spaces, {true, true});
    double                       sum = 0;
    for (const auto &defect : interface::transfer_defects(scene, mesh, scene.contacts[0], all))
      {
        EXPECT_EQ(defect.part.body, 0u);
        sum += defect.rest.sum();
        EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(defect.rest).eigenvalues()[0], -1e-14);
      }
    return sum;
  }
} // namespace

// The coefficient of sqrt(5) (6 s^2 - 6 s + 1) is 3 sqrt(5) / 32, that of the polynomial of degree 3 -3 sqrt(7) / 256.
TEST(TransferDefect, is_that_of_the_first_degree_beyond_the_elements)
{
  EXPECT_NEAR(rest_of_uniform(quarter<2>(1, false)), 5 * 9. / 1024 / 2, 1e-13);
  EXPECT_NEAR(rest_of_uniform(quarter<2>(2, false)), 7 * 9. / 65536 / 3, 1e-13);
  EXPECT_NEAR(rest_of_uniform(quarter<3>(1, false)), 5 * 9. / 1024 / 2, 1e-13);
  EXPECT_NEAR(rest_of_uniform(quarter<3>(2, false)), 7 * 9. / 65536 / 3, 1e-13);
  EXPECT_GT(rest_of_uniform(quarter<3>(1, false), true), 5 * 9. / 1024 / 4);
}

TEST(TransferDefect, is_zero_where_sides_end_at_nodes)
{
  for (const unsigned int degree : {1, 2})
    {
      EXPECT_EQ(rest_of_uniform(quarter<2>(degree, true)), 0.);
      EXPECT_EQ(rest_of_uniform(quarter<3>(degree, true)), 0.);
    }
}
