#include <slipstick/mesh/gmsh_element.h>

namespace slipstick::mesh
{
  GmshElement gmsh_element(const int type)
  {
    switch (type)
      {
        case 15:
          return {0, 1, 1};
        case 1:
          return {1, 2, 2};
        case 8:
          return {1, 2, 3};
        case 26:
          return {1, 2, 4};
        case 27:
          return {1, 2, 5};
        case 28:
          return {1, 2, 6};
        case 2:
          return {2, 3, 3};
        case 9:
          return {2, 3, 6};
        case 20:
          return {2, 3, 9};
        case 21:
          return {2, 3, 10};
        case 22:
          return {2, 3, 12};
        case 23:
          return {2, 3, 15};
        case 24:
          return {2, 3, 15};
        case 25:
          return {2, 3, 21};
        case 3:
          return {2, 4, 4};
        case 16:
          return {2, 4, 8};
        case 10:
          return {2, 4, 9};
        case 36:
          return {2, 4, 16};
        case 37:
          return {2, 4, 25};
        case 4: // tetrahedra, hexahedra, prisms, pyramids and their second-order variants
          return {3, 4, 4};
        case 5:
          return {3, 8, 8};
        case 6:
          return {3, 6, 6};
        case 7:
          return {3, 5, 5};
        case 11:
          return {3, 4, 10};
        case 12:
          return {3, 8, 27};
        case 17:
          return {3, 8, 20};
        case 13:
          return {3, 6, 18};
        case 18:
          return {3, 6, 15};
        case 14:
          return {3, 5, 14};
        case 19:
          return {3, 5, 13};
      }
    return {0, 0, 0};
  }
} // namespace slipstick::mesh
