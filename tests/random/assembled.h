// From a scene to the plain problem: the one place where the reference touches slipstick.
#pragma once

#include "problem.h"

#include <slipstick/scene/scene.h>

#include <mpi.h>

namespace slipstick::random
{
  /// Stiffness, loads, supports and contact rows of the untorn bodies, at load factor 1. Copies of a node within a body
  /// (of triangles and quadrilaterals) are made one. @throws InputError as the program does.
  Problem assembled(scene::Scene<2> scene, const MPI_Comm comm, const bool untorn = true);
} // namespace slipstick::random
