// What the command line means; errors name the nearest option.
#include "../scene/tools.h"

#include <slipstick/app/command_line.h>

using namespace slipstick;
using namespace slipstick::app;
using namespace slipstick::test;

namespace
{
  CommandLine parse(std::vector<const char *> arguments)
  {
    arguments.insert(arguments.begin(), "build/slipstick");
    return parse_command_line(static_cast<int>(arguments.size()), arguments.data());
  }

  void line_refused(const std::vector<const char *> &arguments, const std::vector<std::string> &parts)
  {
    expect_parts(error_of([&] { parse(arguments); }), parts);
  }
} // namespace

TEST(command_line, defaults)
{
  const auto line = parse({"prm/box_on_circle.prm"});
  EXPECT_EQ(line.case_file, "prm/box_on_circle.prm");
  EXPECT_EQ(line.output_directory, "output/box_on_circle");
  EXPECT_TRUE(line.overrides.empty());
  EXPECT_FALSE(line.check || line.quiet || line.verbose || line.list_parameters || line.message);
}

TEST(command_line, all_options)
{
  const auto line = parse({"--set",
                           "Contact circle/Slip bound=150",
                           "a.prm",
                           "--output",
                           "/tmp/run",
                           "--check",
                           "--quiet",
                           "--set",
                           "Body box/Size=[1, 2], 3"});
  EXPECT_EQ(line.case_file, "a.prm");
  EXPECT_EQ(line.overrides, (std::vector<std::string>{"Contact circle/Slip bound=150", "Body box/Size=[1, 2], 3"}));
  EXPECT_EQ(line.output_directory, "/tmp/run");
  EXPECT_TRUE(line.check && line.quiet);
}

TEST(command_line, set_takes_one_argument_and_may_be_joined)
{
  const auto line = parse({"--set=Solver/Tolerance=1e-6", "a.prm"});
  EXPECT_EQ(line.overrides, std::vector<std::string>{"Solver/Tolerance=1e-6"});
  EXPECT_EQ(parse({"--set", "A=1", "a.prm"}).case_file, "a.prm");
}

TEST(command_line, list_parameters_needs_no_case)
{
  EXPECT_EQ(*parse({"--list-parameters"}).list_parameters, scene::ListFormat::text);
  EXPECT_EQ(*parse({"--list-parameters", "json"}).list_parameters, scene::ListFormat::json);
  EXPECT_EQ(*parse({"--list-parameters", "latex"}).list_parameters, scene::ListFormat::latex);
  EXPECT_EQ(*parse({"--list-parameters", "prm"}).list_parameters, scene::ListFormat::prm);
  line_refused({"--list-parameters", "jsn"}, {"jsn", "did you mean 'json'?"});
}

TEST(command_line, help_and_version_are_values)
{
  testing::internal::CaptureStdout();
  const auto help    = parse({"--help"});
  const auto version = parse({"--version"});
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  expect_parts(help.message.value_or(""), {"CASE.prm", "--set", "--output", "--check", "--list-parameters", "--quiet"});
  expect_parts(version.message.value_or(""), {"slipstick "});
}

TEST(command_line, unknown_option_gives_the_nearest)
{
  line_refused({"a.prm", "--chekc"}, {"--chekc", "did you mean '--check'?"});
  line_refused({"a.prm", "--ouput=x"}, {"--ouput", "did you mean '--output'?"});
}

TEST(command_line, missing_case_file)
{
  line_refused({}, {"no case file", "CASE.prm"});
  line_refused({"--quiet"}, {"no case file", "CASE.prm"});
}

TEST(command_line, second_case_file)
{
  line_refused({"a.prm", "b.prm"}, {"'b.prm'", "one case file"});
}

TEST(command_line, set_without_value)
{
  line_refused({"a.prm", "--set", "Solver/Tolerance"}, {"--set Solver/Tolerance", "Name=value"});
  line_refused({"a.prm", "--set", "=3"}, {"--set =3", "Name=value"});
  line_refused({"a.prm", "--set"}, {"--set"});
}

TEST(command_line, contradictions_and_empty_names)
{
  line_refused({"a.prm", "--quiet", "--verbose"}, {"--quiet", "--verbose"});
  line_refused({"a.prm", "--output", ""}, {"--output"});
}
