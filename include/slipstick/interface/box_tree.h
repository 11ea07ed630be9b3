// The tree of base under the name that this layer knows.
#pragma once

#include <slipstick/base/box_tree.h>
