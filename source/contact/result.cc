#include <slipstick/contact/result.h>

#include <deal.II/base/exceptions.h>

namespace slipstick::contact
{
  std::string to_string(const ContactStatus status)
  {
    switch (status)
      {
        case ContactStatus::open:
          return "open";
        case ContactStatus::stick:
          return "stick";
        case ContactStatus::slip:
          return "slip";
      }
    AssertThrow(false, dealii::ExcInternalError());
    return "";
  }
} // namespace slipstick::contact
