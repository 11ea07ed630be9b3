// Whatever is wrong in a scene is an InputError that names place, thing, value and remedy.
#include "tools.h"

using namespace slipstick;
using namespace slipstick::test;

// misspelt

TEST(bad_input, misspelt_parameter_names_file_line_and_nearest)
{
  expect_box_refused("set Slip bound = 500",
                     "set Slip buond = 500",
                     {"box.prm:", "Contact circle/Slip buond", "'500'", "did you mean 'Slip bound'?"});
}

TEST(bad_input, line_number_is_that_of_the_statement)
{
  TemporaryDirectory directory;
  expect_refused(directory.write("a.prm", "set Title = a\n\n# comment\nset Titel = b\n"), {}, {"a.prm:4:", "'Title'"});
}

TEST(bad_input, misspelt_section)
{
  expect_box_refused("subsection Solver", "subsection Slover", {"box.prm:", "'Slover'", "did you mean 'Solver'?"});
}

TEST(bad_input, misspelt_nested_section)
{
  refused({"Solver/SMALB/Proportioning=1"}, {"--set", "'Solver/SMALB'", "did you mean 'SMALBE'?"});
}

TEST(bad_input, misspelt_list)
{
  expect_box_refused("set Bodies ", "set Bodys ", {"box.prm:", "'Bodys'", "'box'", "did you mean 'Bodies'?"});
}

TEST(bad_input, misspelt_value)
{
  refused({"Solver/Algorithm=smable"},
          {"--set", "Solver/Algorithm = 'smable'", "auto, smalbe, semismooth newton, pcg", "'smalbe'"});
  expect_box_refused("= blocks", "= block", {"box.prm:", "Decomposition/Method = 'block'", "METIS", "'blocks'"});
}

TEST(bad_input, right_name_in_the_wrong_section)
{
  refused({"Algorithm=smalbe"}, {"'Algorithm'", "did you mean 'Solver/Algorithm'?"});
}

TEST(bad_input, section_that_no_list_declares)
{
  expect_box_refused("subsection Body box",
                     "subsection Body bxo",
                     {"box.prm:", "'Body bxo'", "set Bodies = box, bxo", "did you mean 'Body box'?"});
}

TEST(bad_input, name_without_a_section)
{
  refused({"Bodies=box, wedge"}, {"'box, wedge'", "no subsection describes 'wedge'", "subsection Body wedge"});
}

TEST(bad_input, unknown_words_are_refused_with_what_is_available)
{
  refused({"Contact circle/Law=coulomb"}, {"'coulomb'", "bonded, frictionless, Tresca, Coulomb"});
  refused({"Contact circle/Discretization=dual"}, {"'dual'", "auto, node to node, mortar"});
  refused({"Contact circle/Slip bound acts on=open"}, {"'open'", "boundary, contact"});
  refused({"Contact search/Mode=on"}, {"'on'", "declared, automatic"});
  refused({"Solver/Tolerance=automatic"}, {"'automatic'", "auto, or a number in (0, 1)"});
  refused({"Body box/Shape=dics"},
          {"'dics'",
           "available: rectangle, disc, half disc, quarter disc, ring, quarter ring, mesh",
           "did you mean 'disc'"});
  refused({"Obstacle disc/Shape=halfplane"}, {"'halfplane'", "circle, hole, half plane, polyline, function"});
}

TEST(bad_input, preconditioner_of_an_algorithm_that_has_none)
{
  refused({"Solver/Algorithm=smalbe", "Solver/Preconditioner=Dirichlet"},
          {"Solver/Preconditioner", "semismooth newton"});
}

// values out of range

TEST(bad_input, material)
{
  refused({"Material elastic/Young modulus=0"}, {"Material elastic/Young modulus", "'0'", "in [1e-20, 1e+20]", "MPa"});
  refused({"Material elastic/Young modulus=2.6e27"}, {"Young modulus", "'2.6e27'", "in [1e-20, 1e+20]"});
  refused({"Material elastic/Density=1e21"}, {"Density", "'1e21'", "in [0, 1e+20]"});
  refused({"Material elastic/Young modulus=1e999"}, {"Young modulus", "'1e999'"});
  refused({"Material elastic/Young modulus=nan"}, {"Young modulus", "'nan'"});
  refused({"Material elastic/Young modulus=1e5 MPa"}, {"Young modulus", "'1e5 MPa'"});
  refused({"Material elastic/Poisson ratio=0.5"}, {"Poisson ratio", "'0.5'", "(-1, 0.5)", "excluded"});
  refused({"Material elastic/Poisson ratio=-1"}, {"Poisson ratio", "'-1'", "(-1, 0.5)"});
}

TEST(bad_input, lengths)
{
  refused({"Body box/Size=0, 10"}, {"Body box/Size", "'0, 10'", "> 0"});
  refused({"Body box/Size=10, -1"}, {"Body box/Size", "'10, -1'", "> 0"});
  refused({"Body box/Size=10, inf"}, {"Body box/Size", "'10, inf'"});
  refused({"Body box/Thickness=0"}, {"Body box/Thickness", "'0'", "in [1e-20, 1e+20]"});
  refused({"Obstacle disc/Radius=-20"}, {"Obstacle disc/Radius", "'-20'", "> 0"});
}

TEST(bad_input, what_bodies_of_revolution_do_not_have)
{
  refused({"Plane state=axissymmetric"}, {"plane stress, plane strain, axisymmetric", "did you mean 'axisymmetric'"});
  refused({"Plane state=axisymmetric", "Body box/Thickness=3"},
          {"Body box/Thickness", "no meaning where Plane state = axisymmetric", "remove it"});
  refused({"Plane state=axisymmetric",
           "Material elastic/Density=1",
           "Body forces=spin",
           "Body force spin/Bodies=box",
           "Body force spin/Angular velocity=10",
           "Body force spin/Axis=1, 0"},
          {"Body force spin/Axis", "rotate about their axis"});
}

TEST(bad_input, vectors_need_two_numbers)
{
  refused({"Body box/Size=10"}, {"Body box/Size", "'10'", "2 numbers"});
  refused({"Body box/Origin=1, 2, 3"}, {"Body box/Origin", "'1, 2, 3'", "2 numbers"});
  refused({"Obstacle disc/Center=5; -20"}, {"Obstacle disc/Center", "'5; -20'", "comma"});
  refused({"Body box/Cells=10"}, {"Body box/Cells", "'10'", "2 whole numbers"});
}

TEST(bad_input, counts)
{
  for (const std::string name : {"Decomposition/Blocks", "Decomposition/Cells per block", "Decomposition/Subdomains"})
    refused({name + "=0"}, {name + " = '0'", "from 1"});
  refused({"Decomposition/Blocks=-2"}, {"'-2'", "from 1"});
  refused({"Decomposition/Blocks=2.5"}, {"'2.5'", "whole number"});
  refused({"Decomposition/Blocks=99999999999999"}, {"'99999999999999'"});
  refused({"Body box/Cells=0, 8"}, {"Body box/Cells = '0, 8'"});
  refused({"Discretization/Degree=3"}, {"Discretization/Degree = '3'", "1 to 2"});
  refused({"Discretization/Degree=0"}, {"Discretization/Degree = '0'", "1 to 2"});
}

TEST(bad_input, tolerance)
{
  for (const std::string value : {"0", "1", "-1e-4", "nan", ""})
    refused({"Solver/Tolerance=" + value}, {"Solver/Tolerance = '" + value + "'", "(0, 1)"});
}

TEST(bad_input, solver_options)
{
  refused({"Solver/SMALBE/Step length=2.5"}, {"Solver/SMALBE/Step length = '2.5'", "(0, 2]"});
  refused({"Solver/SMALBE/Balance reduction=1"}, {"Balance reduction = '1'", "> 1"});
  refused({"Solver/SMALBE/Proportioning=0"}, {"Proportioning = '0'", "> 0"});
}

TEST(bad_input, slip_bound)
{
  refused({"Contact circle/Slip bound=-1"}, {"Contact circle/Slip bound = '-1'", "negative", ">= 0"});
  expect_box_refused("  set Slip bound = 500\n", "", {"Contact circle", "Slip bound is not set", "frictionless"});
}

// names that refer to nothing

TEST(bad_input, unknown_references_give_the_nearest)
{
  refused({"Body box/Material=elastc"}, {"Body box/Material = 'elastc'", "did you mean 'elastic'?"});
  refused({"Contact circle/Master=disk"}, {"Contact circle/Master = 'disk'", "did you mean 'disc'?"});
  refused({"Contact circle/Slave=bos/bottom"}, {"'bos/bottom'", "no body 'bos'", "did you mean 'box'?"});
  refused({"Support held/Boundary=box/lfet"}, {"'box/lfet'", "no boundary 'lfet'", "did you mean 'left'?"});
  refused({"Traction pressed/Boundary=box/Top"}, {"'box/Top'", "no boundary 'Top'", "did you mean 'top'?"});
  refused({"Traction pressed/Boundary=top"}, {"'top'", "BODY/BOUNDARY"});
}

TEST(bad_input, references_that_are_not_set)
{
  expect_box_refused("  set Material  = elastic\n", "", {"Body box", "Material is not set", "elastic"});
  expect_box_refused("  set Size      = 10, 10\n", "", {"Body box", "Size is not set"});
  expect_box_refused("  set Master     = disc\n", "", {"Contact circle", "Master is not set", "disc"});
}

// what does not fit together

TEST(bad_input, duplicate_names)
{
  refused({"Bodies=box, box"}, {"Bodies = 'box, box'", "'box' is declared twice"});
}

TEST(bad_input, invalid_names)
{
  refused({"Bodies=box,,wedge"}, {"Bodies = 'box,,wedge'"});
  refused({"Bodies=a/b"}, {"Bodies = 'a/b'"});
}

TEST(bad_input, two_contacts_on_one_boundary)
{
  refused({"Contacts=circle, second",
           "Contact second/Slave=box/bottom",
           "Contact second/Master=disc",
           "Contact second/Law=frictionless"},
          {"Contact second/Slave", "'box/bottom'", "Contact circle"});
}

TEST(bad_input, two_supports_of_one_component)
{
  refused({"Supports=held, again", "Support again/Boundary=box/left", "Support again/Displacement y=1"},
          {"Support again/Boundary", "'box/left'", "Support held", "along y"});
}

TEST(bad_input, support_that_holds_nothing)
{
  refused({"Support held/Displacement x=free", "Support held/Displacement y=free"},
          {"Support held", "free", "Supports"});
}

TEST(bad_input, nothing_holds_a_body)
{
  refused({"Bodies=box, loose", "Body loose/Size=1, 1", "Body loose/Material=elastic"},
          {"nothing holds body 'loose'", "support", "contact"});
}

TEST(bad_input, no_bodies)
{
  TemporaryDirectory directory;
  expect_refused(directory.write("empty.prm", "set Title = nothing\n"), {}, {"empty.prm", "no body", "set Bodies"});
}

TEST(bad_input, cells_that_blocks_do_not_divide)
{
  refused({"Body box/Cells=40, 42"}, {"Body box/Cells = '40, 42'", "42 cells", "Blocks = 4", "auto"});
}

TEST(bad_input, cells_need_not_be_divisible_without_blocks)
{
  EXPECT_NO_THROW(scene::read_scene(prm("box_on_circle"), {"Body box/Cells=40, 42", "Decomposition/Method=METIS"}));
}

TEST(bad_input, algorithm_that_does_not_fit)
{
  refused({"Solver/Algorithm=pcg"}, {"Solver/Algorithm = 'pcg'", "contact", "auto"});
  expect_refused(prm("box_linear"), {"Solver/Algorithm=smalbe"}, {"Solver/Algorithm = 'smalbe'", "contact", "auto"});
}

// formulas

TEST(bad_input, formula_names_parameter_and_line)
{
  expect_box_refused("set Traction y = -250",
                     "set Traction y = -250*z",
                     {"box.prm:", "Traction pressed/Traction y", "'-250*z'", "\"z\"", "x, y, t, pi"});
}
