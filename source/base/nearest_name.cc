#include <slipstick/base/nearest_name.h>

#include <algorithm>
#include <cctype>

namespace slipstick
{
  namespace
  {
    constexpr std::size_t longest_name = 200; // characters compared: the cost is the product of the lengths

    std::string to_lower(std::string text)
    {
      for (char &c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return text;
    }
  } // namespace

  unsigned int edit_distance(const std::string &first, const std::string &second)
  {
    const std::string a = to_lower(first), b = to_lower(second);

    // distance[i][j]: from the first i characters of a to the first j of b
    std::vector<std::vector<unsigned int>> distance(a.size() + 1, std::vector<unsigned int>(b.size() + 1));
    for (unsigned int i = 0; i <= a.size(); ++i)
      distance[i][0] = i;
    for (unsigned int j = 0; j <= b.size(); ++j)
      distance[0][j] = j;
    for (unsigned int i = 1; i <= a.size(); ++i)
      for (unsigned int j = 1; j <= b.size(); ++j)
        {
          distance[i][j] = std::min(
            {distance[i - 1][j] + 1, distance[i][j - 1] + 1, distance[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
          if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
            distance[i][j] = std::min(distance[i][j], distance[i - 2][j - 2] + 1);
        }
    return distance[a.size()][b.size()];
  }

  std::optional<std::string> nearest_name(const std::string &name, const std::vector<std::string> &candidates)
  {
    std::optional<std::string> nearest;
    unsigned int               least = 0;
    for (const std::string &candidate : candidates)
      {
        if (name.size() > longest_name || candidate.size() > longest_name)
          continue;
        const unsigned int distance = edit_distance(name, candidate);
        if (2 * distance <= std::max(name.size(), candidate.size()) && (!nearest || distance < least))
          {
            nearest = candidate;
            least   = distance;
          }
      }
    return nearest;
  }

  std::string suggest_name(const std::string &name, const std::vector<std::string> &candidates)
  {
    if (candidates.empty())
      return "there are none";
    const auto nearest = nearest_name(name, candidates);
    return (nearest ? "did you mean '" + *nearest + "'? " : std::string()) + "valid: " + join_names(candidates);
  }

  std::string join_names(const std::vector<std::string> &names)
  {
    std::string joined;
    for (const std::string &name : names)
      joined += (joined.empty() ? "" : ", ") + name;
    return joined;
  }
} // namespace slipstick
