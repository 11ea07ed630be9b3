// Headers that are costly to parse and that most layers need.
#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/point.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>
