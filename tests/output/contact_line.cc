#include <slipstick/output/contact_line.h>

#include "temporary_directory.h"

#include <deal.II/base/utilities.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <limits>

#include <sys/wait.h>

using namespace slipstick;
using namespace slipstick::output;
using contact::ContactNode;
using contact::ContactStatus;

namespace
{
  using ContactLine = TemporaryDirectory;

  const std::string header =
    "pair,slave body,x,y,s,gap,pressure,tangential_traction,slip,status,step,slip_bound,total_slip,initial_gap\n";

  ContactNode node(const unsigned int pair, const double arc_length, const double pressure)
  {
    ContactNode result;
    result.pair       = pair;
    result.position   = {{arc_length, 2, 0}};
    result.arc_length = arc_length;
    result.pressure   = pressure;
    result.status     = pressure > 0 ? ContactStatus::stick : ContactStatus::open;
    return result;
  }

  // The bytes of an array in a .vtp, without the leading size.
  std::vector<double> array_of(const std::string &vtp, const std::string &name)
  {
    const auto                       begin  = vtp.find('>', vtp.find("Name=\"" + name + '"')) + 1;
    const std::string                base64 = vtp.substr(begin, vtp.find('<', begin) - begin);
    const std::vector<unsigned char> bytes  = dealii::Utilities::decode_base64(base64);
    std::uint64_t                    n_bytes;
    std::memcpy(&n_bytes, bytes.data(), 8);
    EXPECT_EQ(bytes.size(), n_bytes + 8);
    std::vector<double> values(n_bytes / 8);
    std::memcpy(values.data(), bytes.data() + 8, n_bytes);
    return values;
  }

  // Output and exit status of read_vtp.py.
  std::pair<std::string, int> read_with_vtk(const std::string &file)
  {
    FILE *pipe = popen(("/usr/bin/python3 " VTP_READER " '" + file + "'").c_str(), "r");
    if (pipe == nullptr)
      return {"", 77};
    std::string           text;
    std::array<char, 256> buffer;
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr)
      text += buffer.data();
    return {text, WEXITSTATUS(pclose(pipe))};
  }
} // namespace

TEST_F(ContactLine, csv_row_holds_the_columns_of_the_header)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  ContactNode           slipping;
  slipping.position            = {{0.1, 1. / 3, 0}};
  slipping.arc_length          = 1;
  slipping.gap                 = -1e-17;
  slipping.initial_gap         = -0.02;
  slipping.pressure            = 1259.5;
  slipping.tangential_traction = -500;
  slipping.slip                = 1e-3;
  slipping.status              = ContactStatus::slip;
  slipping.slip_bound          = 500;
  slipping.total_slip          = -2e-3;
  write_contact_csv(directory, {{"circle"}, {"box"}}, {{7, {slipping}}});
  EXPECT_EQ(content(directory.path("contact.csv")),
            header + "circle,box,0.1,0.3333333333333333,1,-1e-17,1259.5,-500,0.001,slip,7,500,-0.002,-0.02\n");
}

TEST_F(ContactLine, csv_goes_by_step_pair_and_arc_length)
{
  const OutputDirectory          directory(root, MPI_COMM_WORLD);
  const std::vector<ContactNode> nodes = {node(1, 0, 0), node(0, 2, 0), node(0, 1, 0)};
  write_contact_csv(directory, {{"a", "b"}, {"A", "B"}}, {{0, nodes}, {1, {node(0, 0, 3)}}});
  EXPECT_EQ(content(directory.path("contact.csv")),
            header + "a,A,1,2,1,0,0,0,0,open,0,0,0,0\n"
                     "a,A,2,2,2,0,0,0,0,open,0,0,0,0\n"
                     "b,B,0,2,0,0,0,0,0,open,0,0,0,0\n"
                     "a,A,0,2,0,0,3,0,0,stick,1,0,0,0\n");
}

TEST_F(ContactLine, csv_quotes_names_with_commas)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  write_contact_csv(directory, {{"a, b"}, {"A"}}, {{0, {node(0, 0, 0)}}});
  EXPECT_EQ(content(directory.path("contact.csv")).find("\"a, b\",A,0"), header.size());
}

TEST_F(ContactLine, vtp_carries_its_step_in_the_name)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  write_contact_vtp(directory, {12, {}});
  EXPECT_TRUE(std::filesystem::exists(root / "contact_012.vtp"));
}

TEST_F(ContactLine, vtp_holds_exact_values_in_order_of_arc_length)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  write_contact_vtp(directory, {0, {node(0, 2, 1. / 3), node(0, 1, 0.1)}});
  EXPECT_EQ(array_of(content(directory.path("contact_000.vtp")), "pressure"), std::vector<double>({0.1, 1. / 3}));
}

TEST_F(ContactLine, vtp_opens_in_vtk_with_a_line_a_pair)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  write_contact_vtp(directory, {0, {node(0, 1, 5), node(1, 7, 0), node(0, 0, 0), node(2, 3, 1), node(2, 4, 1)}});
  if (is_root())
    {
      const auto [text, status] = read_with_vtk(directory.path("contact_000.vtp"));
      if (status == 77)
        GTEST_SKIP() << "python3-vtk9 is not installed";
      EXPECT_EQ(status, 0);
      EXPECT_EQ(text,
                "points 5 verts 1 lines 2\ncell 2\ncell 0 1\ncell 3 4\n"
                "point 0.0 2.0 0.0 0.0 0.0 0.0\npoint 1.0 2.0 0.0 1.0 5.0 1.0\npoint 7.0 2.0 0.0 7.0 0.0 0.0\n"
                "point 3.0 2.0 0.0 3.0 1.0 1.0\npoint 4.0 2.0 0.0 4.0 1.0 1.0\n");
    }
}

TEST_F(ContactLine, vtp_without_nodes_or_with_nan_opens_in_vtk)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  write_contact_vtp(directory, {0, {}});
  write_contact_vtp(directory, {1, {node(0, 0, std::numeric_limits<double>::quiet_NaN()), node(0, 1, 1)}});
  if (is_root())
    {
      const auto [nothing, status] = read_with_vtk(directory.path("contact_000.vtp"));
      if (status == 77)
        GTEST_SKIP() << "python3-vtk9 is not installed";
      EXPECT_EQ(nothing, "points 0 verts 0 lines 0\n");
      const auto [nan, nan_status] = read_with_vtk(directory.path("contact_001.vtp"));
      EXPECT_EQ(nan_status, 0);
      EXPECT_NE(nan.find("point 0.0 2.0 0.0 0.0 nan 0.0"), std::string::npos) << nan;
    }
}

TEST(ContactStatusNames, are_those_of_the_contract)
{
  EXPECT_EQ(contact::to_string(ContactStatus::open), "open");
  EXPECT_EQ(contact::to_string(ContactStatus::stick), "stick");
  EXPECT_EQ(contact::to_string(ContactStatus::slip), "slip");
}
