// Declaration of parameters: the default is the member's value; the text contains unit, range and meaning.
#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/point.h>

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slipstick::scene
{
  /// Component names used in parameters.
  inline const std::array<std::string, 3> axes = {{"x", "y", "z"}};

  /// The smallest value of numbers that must be positive, and the largest magnitude of all numbers in a scene: products
  /// of four of them are far from overflow, and no system of units needs a larger range.
  constexpr double smallest_number = 1e-30, largest_number = 1e30;

  /// Limits of moduli [MPa] and thicknesses [mm]: materials do not exceed them in any system of units (diamond has
  /// 1.2e12 Pa, 1.2e18 N/km^2), and beyond them rounding errors of coordinates (1e-16 of an edge) in a gap would cause
  /// pressures larger than those of the loads.
  constexpr double least_of_material = 1e-20, most_of_material = 1e20;

  /// Whether a number is finite and within the largest magnitude.
  bool is_usable(const double value);

  /// Numbers between two limits; an open limit is excluded. Infinite numbers are never contained.
  struct Interval
  {
    double lower      = -std::numeric_limits<double>::infinity();
    double upper      = std::numeric_limits<double>::infinity();
    bool   lower_open = false;
    bool   upper_open = false;

    static Interval above(const double lower);
    static Interval from(const double lower);
    static Interval inside(const double lower, const double upper);
    static Interval between(const double lower, const double upper); // both included

    bool        contains(const double value) const;
    std::string text() const; // text to follow "a number": " > 0", " in (0, 1)", or empty
  };

  /// What a FIELD may contain, for messages: "a number or a formula of x, y, t".
  template <int dim>
  std::string field_format()
  {
    return std::string("a number or a formula of x, y, ") + (dim == 3 ? "z, t" : "t");
  }

  /// One value of an enumeration with its spelling in the .prm.
  template <typename Enum>
  using Choices = std::vector<std::pair<std::string, Enum>>;

  /// Start of the description of a pattern that allows a few words; the words follow, separated by commas.
  extern const std::string choice_prefix;

  /// Declares a parameter that accepts the texts for which @p allows holds. @p store receives the text: the default
  /// immediately, later every value set. @p unit is empty or a text such as "MPa".
  void add_entry(dealii::ParameterHandler                       &prm,
                 const std::string                              &name,
                 const std::string                              &default_text,
                 const std::string                              &unit,
                 const std::string                              &meaning,
                 const std::string                              &allowed,
                 const std::function<bool(const std::string &)> &allows,
                 const std::function<void(const std::string &)> &store);

  void add_number(dealii::ParameterHandler &prm,
                  const std::string        &name,
                  double                   &value,
                  const std::string        &unit,
                  const Interval           &interval,
                  const std::string        &meaning);

  /// Declares an integer from @p least to @p most.
  void add_count(dealii::ParameterHandler &prm,
                 const std::string        &name,
                 unsigned int             &value,
                 const unsigned int        least,
                 const unsigned int        most,
                 const std::string        &meaning);

  /// Declares an integer from 1 to @p most, or `auto`, which is stored as 0.
  void add_count_or_auto(dealii::ParameterHandler &prm,
                         const std::string        &name,
                         unsigned int             &value,
                         const unsigned int        most,
                         const std::string        &meaning);

  /// Declares @p dim numbers separated by commas.
  template <int dim>
  void add_point(dealii::ParameterHandler &prm,
                 const std::string        &name,
                 dealii::Point<dim>       &value,
                 const std::string        &unit,
                 const Interval           &interval,
                 const std::string        &meaning);

  /// Declares @p dim integers from 1 to @p most, or `auto`, which is stored as no value.
  template <int dim>
  void add_counts_or_auto(dealii::ParameterHandler                     &prm,
                          const std::string                            &name,
                          std::optional<std::array<unsigned int, dim>> &value,
                          const unsigned int                            most,
                          const std::string                            &meaning);

  void add_flag(dealii::ParameterHandler &prm, const std::string &name, bool &value, const std::string &meaning);

  /// Declares free text, checked where it is read; @p allowed describes it.
  void add_text(dealii::ParameterHandler &prm,
                const std::string        &name,
                std::string              &value,
                const std::string        &unit,
                const std::string        &allowed,
                const std::string        &meaning);

  /// Declares one of a few words; see add_choice().
  void add_word(dealii::ParameterHandler                       &prm,
                const std::string                              &name,
                const std::string                              &default_word,
                const std::vector<std::string>                 &words,
                const std::string                              &meaning,
                const std::function<void(const std::string &)> &store);

  template <typename Enum>
  void add_choice(dealii::ParameterHandler &prm,
                  const std::string        &name,
                  Enum                     &value,
                  const Choices<Enum>      &choices,
                  const std::string        &meaning)
  {
    std::string              default_word;
    std::vector<std::string> words;
    for (const auto &choice : choices)
      {
        words.push_back(choice.first);
        if (choice.second == value)
          default_word = choice.first;
      }
    add_word(prm, name, default_word, words, meaning, [&value, choices](const std::string &word) {
      for (const auto &choice : choices)
        if (choice.first == word)
          value = choice.second;
    });
  }
} // namespace slipstick::scene
