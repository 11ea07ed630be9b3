// The syntax of .prm files.
#include "tools.h"

#include <slipstick/scene/prm_file.h>

using namespace slipstick;
using namespace slipstick::scene;
using namespace slipstick::test;

namespace
{
  std::vector<Setting> read_file(const std::string &text)
  {
    TemporaryDirectory directory;
    return read_settings(directory.write("a.prm", text), {});
  }

  void file_refused(const std::string &text, const std::vector<std::string> &parts)
  {
    expect_parts(error_of([&] { read_file(text); }), parts);
  }
} // namespace

TEST(prm_file, comments_blanks_continuation_and_line_ends)
{
  const auto settings = read_file("\xEF\xBB\xBF# head\r\n"
                                  "set  Slip   bound = 5 # MPa\r\n"
                                  "subsection Contact   circle\n"
                                  "\tset Law = Tres\\\n"
                                  "ca\n"
                                  "end\n");
  ASSERT_EQ(settings.size(), 3u);
  EXPECT_EQ(settings[0].path, "Slip bound");
  EXPECT_EQ(settings[0].value, "5");
  EXPECT_TRUE(settings[1].is_section);
  EXPECT_EQ(settings[2].path, "Contact circle/Law");
  EXPECT_EQ(settings[2].value, "Tresca");
  EXPECT_NE(settings[2].where.find("a.prm:4"), std::string::npos);
}

TEST(prm_file, value_may_hold_equals_and_slash)
{
  EXPECT_EQ(read_file("set Traction y = x == 2 ? 1/3 : 0\n")[0].value, "x == 2 ? 1/3 : 0");
}

TEST(prm_file, include_is_relative_to_the_including_file)
{
  TemporaryDirectory directory;
  std::filesystem::create_directory(directory.path / "sub");
  directory.write("sub/common.prm", "set Title = common\n");
  const auto settings = read_settings(directory.write("a.prm", "include sub/common.prm\nset Title = own\n"), {});
  ASSERT_EQ(settings.size(), 2u);
  EXPECT_EQ(settings[0].value, "common");
  EXPECT_NE(settings[0].where.find("common.prm:1"), std::string::npos);
}

TEST(prm_file, file_that_includes_itself_is_refused)
{
  TemporaryDirectory directory;
  const std::string  file = directory.write("a.prm", "include a.prm\n");
  expect_parts(error_of([&] { read_settings(file, {}); }), {"a.prm:1", "includes itself"});
}

TEST(prm_file, syntax_errors_name_the_line)
{
  file_refused("set Title = a\nste Plane state = b\n", {"a.prm:2", "ste Plane state = b", "did you mean 'set'?"});
  file_refused("set Title\n", {"a.prm:1", "set Title", "NAME = VALUE"});
  file_refused("set = 3\n", {"a.prm:1"});
  file_refused("subsection Solver\nset A = 1\n", {"a.prm:1", "Solver", "no end"});
  file_refused("set A = 1\nend\n", {"a.prm:2", "without an open subsection"});
  file_refused("subsection Solver\nend Solver\n", {"a.prm:2", "Solver"});
  file_refused("subsection\nend\n", {"a.prm:1"});
}

TEST(prm_file, parameter_set_twice_is_refused_with_both_lines)
{
  file_refused("set Title = a\nset Title = b\n", {"a.prm:2", "'b'", "a.prm:1"});
}

TEST(prm_file, missing_file_gives_the_nearest)
{
  expect_parts(error_of([] { read_settings(prm("box_on_cirkle"), {}); }),
               {"box_on_cirkle", "did you mean 'box_on_circle.prm'?"});
  expect_parts(error_of([] { read_settings("/no/such/directory/a.prm", {}); }), {"/no/such/directory/a.prm"});
  expect_parts(error_of([] { read_settings(SLIPSTICK_SOURCE_DIR, {}); }), {"cannot be read"});
}

TEST(prm_file, overrides_follow_the_file)
{
  const auto settings = read_settings(prm("box_linear"), {" Solver / SMALBE/Step  length = 1 "});
  EXPECT_EQ(settings.back().path, "Solver/SMALBE/Step length");
  EXPECT_EQ(settings.back().value, "1");
}

TEST(prm_file, overrides_without_equals_or_with_comments_are_refused)
{
  expect_parts(error_of([] { read_settings(prm("box_linear"), {"Solver/Tolerance"}); }),
               {"--set Solver/Tolerance", "'='"});
  expect_parts(error_of([] { read_settings(prm("box_linear"), {"=3"}); }), {"--set =3"});
  expect_parts(error_of([] { read_settings(prm("box_linear"), {"Title=a # b"}); }), {"Title=a # b", "'#'"});
}
