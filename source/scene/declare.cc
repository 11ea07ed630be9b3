#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>

#include <deal.II/base/patterns.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace slipstick::scene
{
  const std::string choice_prefix = "one of: ";

  namespace
  {
    /// A pattern defined by a predicate and its description.
    class Allowed : public dealii::Patterns::PatternBase
    {
    public:
      Allowed(const std::string &description, const std::function<bool(const std::string &)> &predicate)
        : text(description)
        , allows(predicate)
      {}

      bool match(const std::string &value) const override
      {
        return allows(value);
      }

      std::string description(const OutputStyle style = Machine) const override
      {
        if (style != LaTeX)
          return text;
        std::string escaped;
        for (const char c : text)
          if (c == '<' || c == '>')
            escaped += std::string("$") + c + "$";
          else
            escaped += (std::string("_%&#").find(c) != std::string::npos ? "\\" : "") + std::string(1, c);
        return escaped;
      }

      std::unique_ptr<PatternBase> clone() const override
      {
        return std::make_unique<Allowed>(text, allows);
      }

    private:
      std::string                              text;
      std::function<bool(const std::string &)> allows;
    };

    std::optional<unsigned int> parse_count(const std::string &text)
    {
      const std::string digits = trim(text);
      unsigned int      value  = 0;
      const auto        result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (digits.empty() || result.ec != std::errc() || result.ptr != digits.data() + digits.size())
        return {};
      return value;
    }

    bool is_count(const std::string &text, const unsigned int least, const unsigned int most)
    {
      const auto value = parse_count(text);
      return value && least <= *value && *value <= most;
    }

    bool is_number(const std::string &text, const Interval &interval)
    {
      const auto value = parse_number(text);
      return value && interval.contains(*value);
    }

    std::string count_text(const unsigned int least, const unsigned int most)
    {
      return std::to_string(least) + " to " + std::to_string(most);
    }
  } // namespace

  bool is_usable(const double value)
  {
    return std::abs(value) <= largest_number;
  }

  Interval Interval::above(const double lower)
  {
    return {lower, std::numeric_limits<double>::infinity(), true, false};
  }

  Interval Interval::from(const double lower)
  {
    Interval interval;
    interval.lower = lower;
    return interval;
  }

  Interval Interval::inside(const double lower, const double upper)
  {
    return {lower, upper, true, true};
  }

  Interval Interval::between(const double lower, const double upper)
  {
    return {lower, upper, false, false};
  }

  bool Interval::contains(const double value) const
  {
    const bool may_be_tiny =
      !(lower_open && lower == 0) || value >= smallest_number; // coordinates may be zero up to rounding
    return is_usable(value) && may_be_tiny && (lower_open ? value > lower : value >= lower) &&
           (upper_open ? value < upper : value <= upper);
  }

  std::string Interval::text() const
  {
    if (std::isinf(lower) && std::isinf(upper))
      return "";
    if (std::isinf(upper))
      return std::string(" ") + (lower_open ? "> " : ">= ") + number_text(lower);
    if (std::isinf(lower))
      return std::string(" ") + (upper_open ? "< " : "<= ") + number_text(upper);
    return std::string(" in ") + (lower_open ? "(" : "[") + number_text(lower) + ", " + number_text(upper) +
           (upper_open ? ")" : "]");
  }

  void add_entry(dealii::ParameterHandler                       &prm,
                 const std::string                              &name,
                 const std::string                              &default_text,
                 const std::string                              &unit,
                 const std::string                              &meaning,
                 const std::string                              &allowed,
                 const std::function<bool(const std::string &)> &allows,
                 const std::function<void(const std::string &)> &store)
  {
    prm.declare_entry(name, default_text, Allowed(allowed, allows), (unit.empty() ? "" : "[" + unit + "] ") + meaning);
    prm.add_action(name, store);
  }

  void add_number(dealii::ParameterHandler &prm,
                  const std::string        &name,
                  double                   &value,
                  const std::string        &unit,
                  const Interval           &interval,
                  const std::string        &meaning)
  {
    add_entry(
      prm,
      name,
      number_text(value),
      unit,
      meaning,
      "a number" + interval.text(),
      [interval](const std::string &text) { return is_number(text, interval); },
      [&value](const std::string &text) { value = *parse_number(text); });
  }

  void add_count(dealii::ParameterHandler &prm,
                 const std::string        &name,
                 unsigned int             &value,
                 const unsigned int        least,
                 const unsigned int        most,
                 const std::string        &meaning)
  {
    add_entry(
      prm,
      name,
      std::to_string(value),
      "",
      meaning,
      "a whole number from " + count_text(least, most),
      [least, most](const std::string &text) { return is_count(text, least, most); },
      [&value](const std::string &text) { value = *parse_count(text); });
  }

  void add_count_or_auto(dealii::ParameterHandler &prm,
                         const std::string        &name,
                         unsigned int             &value,
                         const unsigned int        most,
                         const std::string        &meaning)
  {
    add_entry(
      prm,
      name,
      value == 0 ? "auto" : std::to_string(value),
      "",
      meaning,
      "auto, or a whole number from " + count_text(1, most),
      [most](const std::string &text) { return text == "auto" || is_count(text, 1, most); },
      [&value](const std::string &text) { value = text == "auto" ? 0 : *parse_count(text); });
  }

  template <int dim>
  void add_point(dealii::ParameterHandler &prm,
                 const std::string        &name,
                 dealii::Point<dim>       &value,
                 const std::string        &unit,
                 const Interval           &interval,
                 const std::string        &meaning)
  {
    std::vector<std::string> defaults;
    for (unsigned int d = 0; d < dim; ++d)
      defaults.push_back(number_text(value[d]));
    const auto allows = [interval](const std::string &text) {
      const auto parts = split_list(text);
      return parts.size() == dim && std::all_of(parts.begin(), parts.end(), [&interval](const std::string &part) {
               return is_number(part, interval);
             });
    };
    const auto store = [&value](const std::string &text) {
      const auto parts = split_list(text);
      for (unsigned int d = 0; d < dim; ++d)
        value[d] = *parse_number(parts[d]);
    };
    add_entry(prm,
              name,
              join_names(defaults),
              unit,
              meaning,
              std::to_string(dim) + " numbers" + interval.text() + ", separated by a comma",
              allows,
              store);
  }

  template <int dim>
  void add_counts_or_auto(dealii::ParameterHandler                     &prm,
                          const std::string                            &name,
                          std::optional<std::array<unsigned int, dim>> &value,
                          const unsigned int                            most,
                          const std::string                            &meaning)
  {
    const auto allows = [most](const std::string &text) {
      const auto parts = split_list(text);
      return text == "auto" ||
             (parts.size() == dim && std::all_of(parts.begin(), parts.end(), [most](const std::string &part) {
                return is_count(part, 1, most);
              }));
    };
    const auto store = [&value](const std::string &text) {
      value.reset();
      if (text == "auto")
        return;
      const auto parts = split_list(text);
      value.emplace();
      for (unsigned int d = 0; d < dim; ++d)
        (*value)[d] = *parse_count(parts[d]);
    };
    add_entry(prm,
              name,
              "auto",
              "",
              meaning,
              "auto, or " + std::to_string(dim) + " whole numbers from " + count_text(1, most) +
                ", separated by a comma" + (dim == 3 ? " (of a cuboid; of round shapes: Cells around)" : ""),
              allows,
              store);
  }

  void add_flag(dealii::ParameterHandler &prm, const std::string &name, bool &value, const std::string &meaning)
  {
    add_choice(prm, name, value, Choices<bool>{{"true", true}, {"false", false}}, meaning);
  }

  void add_text(dealii::ParameterHandler &prm,
                const std::string        &name,
                std::string              &value,
                const std::string        &unit,
                const std::string        &allowed,
                const std::string        &meaning)
  {
    add_entry(
      prm,
      name,
      value,
      unit,
      meaning,
      allowed,
      [](const std::string &) { return true; },
      [&value](const std::string &text) { value = text; });
  }

  void add_word(dealii::ParameterHandler                       &prm,
                const std::string                              &name,
                const std::string                              &default_word,
                const std::vector<std::string>                 &words,
                const std::string                              &meaning,
                const std::function<void(const std::string &)> &store)
  {
    add_entry(
      prm,
      name,
      default_word,
      "",
      meaning,
      choice_prefix + join_names(words),
      [words](const std::string &text) { return std::find(words.begin(), words.end(), text) != words.end(); },
      store);
  }

  template void add_point(dealii::ParameterHandler &,
                          const std::string &,
                          dealii::Point<2> &,
                          const std::string &,
                          const Interval &,
                          const std::string &);
  template void add_counts_or_auto<2>(dealii::ParameterHandler &,
                                      const std::string &,
                                      std::optional<std::array<unsigned int, 2>> &,
                                      const unsigned int,
                                      const std::string &);
  template void add_point(dealii::ParameterHandler &,
                          const std::string &,
                          dealii::Point<3> &,
                          const std::string &,
                          const Interval &,
                          const std::string &);
  template void add_counts_or_auto<3>(dealii::ParameterHandler &,
                                      const std::string &,
                                      std::optional<std::array<unsigned int, 3>> &,
                                      const unsigned int,
                                      const std::string &);
} // namespace slipstick::scene
