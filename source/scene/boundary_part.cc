#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/boundary_part.h>

#include <algorithm>
#include <regex>

namespace slipstick::scene
{
  namespace
  {
    const std::string separator = " where ";
  } // namespace

  BoundaryPart part_of_boundary(const std::string &boundary)
  {
    const auto at = (boundary + " ").find(separator);
    if (at == std::string::npos)
      return {trim(boundary), ""};
    const std::string condition = trim(boundary.substr(std::min(boundary.size(), at + separator.size())));
    if (condition.empty())
      throw InputError("boundary '" + boundary + "': there is no condition after 'where'",
                       "write one, for example " + trim(boundary.substr(0, at)) + " where x<10, or leave 'where' out");
    return {trim(boundary.substr(0, at)), condition};
  }

  std::string to_string(const BoundaryPart &part)
  {
    return part.condition.empty() ? part.name : part.name + separator + part.condition;
  }

  template <int dim>
  void check_condition(const BoundaryPart &part, const std::string &path)
  {
    if (part.condition.empty())
      return;
    static const std::regex load_factor("(^|[^A-Za-z0-9_])t([^A-Za-z0-9_]|$)");
    if (std::regex_search(part.condition, load_factor))
      throw InputError(path + ": the condition '" + part.condition + "' of boundary '" + part.name +
                         "' has the load factor t, and boundaries are the same in all load steps",
                       std::string("write a condition in x") + (dim == 3 ? ", y and z" : " and y") +
                         "; a load may be a formula of t");
    Field<dim>(part.condition, path);
  }

  template <int dim>
  std::vector<std::pair<std::string, BoundaryName>> used_boundaries(const Scene<dim> &scene)
  {
    std::vector<std::pair<std::string, BoundaryName>> used;
    for (const auto &support : scene.supports)
      if (!support.point)
        used.emplace_back("Support " + support.name, support.where);
    for (const auto &foundation : scene.foundations)
      used.emplace_back("Foundation " + foundation.name, foundation.where);
    for (const auto &traction : scene.tractions)
      used.emplace_back("Traction " + traction.name, traction.where);
    for (const auto &contact : scene.contacts)
      {
        used.emplace_back("Contact " + contact.name + "/Slave", contact.slave);
        if (contact.master)
          used.emplace_back("Contact " + contact.name + "/Master", *contact.master);
      }
    return used;
  }

  template <int dim>
  bool has_boundary_parts(const Scene<dim> &scene)
  {
    const auto used = used_boundaries(scene);
    return std::any_of(used.begin(), used.end(), [](const auto &one) {
      return !part_of_boundary(one.second.boundary).condition.empty();
    });
  }

  template bool has_boundary_parts(const Scene<2> &);
  template bool has_boundary_parts(const Scene<3> &);
  template void check_condition<2>(const BoundaryPart &, const std::string &);
  template void check_condition<3>(const BoundaryPart &, const std::string &);
  template std::vector<std::pair<std::string, BoundaryName>> used_boundaries(const Scene<2> &);
  template std::vector<std::pair<std::string, BoundaryName>> used_boundaries(const Scene<3> &);
} // namespace slipstick::scene
