// Tests made of the examples in the headers by extract_examples.py.
#include "faced_problem.h"

#include <slipstick/qp/face_solver.h>
#include <slipstick/qp/feasible_point.h>
#include <slipstick/qp/mpgp.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/qp/semismooth_newton.h>
#include <slipstick/qp/smalbe.h>

#include <cmath>

#include "qp_examples.inc"
