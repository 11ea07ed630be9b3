// The examples of the headers, each a test: extract_examples.py.
#include <slipstick/tfeti/coarse_solver.h>
#include <slipstick/tfeti/recovery.h>
#include <slipstick/tfeti/semidefinite_factor.h>

#include <gtest/gtest.h>

#include <cmath>

#include "tfeti_examples.inc"
