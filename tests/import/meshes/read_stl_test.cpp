#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/import/small_meshes.hpp"

namespace sulcus::test::read_stl_test {
namespace {

class StlRead : public testing::TestWithParam<MeshCase> {};
class StlRefused : public testing::TestWithParam<MeshCase> {};

TEST_P(StlRead, IsTheTetrahedron) {
  const ScratchFolder folder;
  expect_tetrahedron(read_mesh(folder.write(GetParam().name, GetParam().contents)));
}

TEST_P(StlRefused, InOneLine) { expect_refused(GetParam()); }

const std::string kBom = "\xef\xbb\xbf";

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return text;
}

/// The text's four facets, as solids of two.
std::string two_solids() {
  std::string text = text_stl();
  const std::size_t third =
      text.find("facet", text.find("endfacet", text.find("endfacet") + 1) + 8);
  return text.insert(third, "endsolid a\n\nsolid the second half\n");
}

std::string with_attributes() {
  std::string file = stl();
  for (std::size_t t = 0; t < 4; ++t) file[84 + 50 * t + 48] = file[84 + 50 * t + 49] = 0x7f;
  return file;
}

INSTANTIATE_TEST_SUITE_P(
    ReadStl, StlRead,
    testing::Values(
        MeshCase{"binary.stl", stl(), ""},
        MeshCase{"header.stl", stl().replace(0, 80, std::string(80, '\0')), ""},
        MeshCase{"solid_line.stl", stl().replace(0, 20, "solid a\nfacet normal"), ""},
        MeshCase{"mark.stl", kBom + stl().substr(3), ""},
        MeshCase{"attributes.stl", with_attributes(), ""},
        MeshCase{"some_bytes.stl", stl() + "made by hand", ""},
        MeshCase{"zeros_behind.stl", stl() + std::string(512, '\0'), ""},
        MeshCase{"text.stl", text_stl(), ""}, MeshCase{"TEXT.STL", upper(text_stl()), ""},
        MeshCase{"mixed.stl", replaced(replaced(text_stl(), "solid", "Solid"), "facet", "Facet"),
                 ""},
        MeshCase{"marked_text.stl", kBom + text_stl(), ""},
        MeshCase{"blanks.stl", "\n \t" + replaced(text_stl(), "vertex", "\t  vertex\t"), ""},
        MeshCase{"windows.stl", replaced(text_stl(), "\n", "\r\n"), ""},
        MeshCase{"old_mac.stl", replaced(text_stl(), "\n", "\r"), ""},
        MeshCase{"exponents.stl", text_stl("+1.0e+00 -0.0E-7 1e-400"), ""},
        MeshCase{"points.stl", text_stl("1. .0 -0"), ""},
        MeshCase{"no_normals.stl", replaced(text_stl(), "facet normal 0 0 0", "facet"), ""},
        MeshCase{"nan_normals.stl",
                 replaced(text_stl(), "normal 0 0 0", "normal nan -nan(ind) 1.#QNAN"), ""},
        MeshCase{
            "apart.stl",
            replaced(replaced(replaced(text_stl(), "endloop", "end loop"), "endfacet", "end facet"),
                     "endsolid", "end solid"),
            ""},
        MeshCase{"no_names.stl", replaced(text_stl(), "solid a", "solid"), ""},
        MeshCase{"one_line.stl", "solid\n" + replaced(text_stl().substr(8), "\n", " "), ""},
        MeshCase{"named_facet.stl", replaced(text_stl(), "solid a", "solid facet 7, \xc3\xa4"), ""},
        MeshCase{"solids.stl", two_solids(), ""},
        MeshCase{"no_last_end.stl", text_stl("1 0 0", "endsolid"), ""}),
    name_of);

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    ReadStl, StlRefused,
    testing::Values(
        MeshCase{"none.stl", stl(0, kCorners, {}), "found 0 triangles, expected at least 4"},
        MeshCase{"one.stl", stl(1, kCorners, {{0, 1, 2}}), "found 1 triangles"},
        MeshCase{"count.stl", stl(4000000000u),
                 "triangle count: found 4000000000 in a file of 284"},
        MeshCase{
            "many.stl", stl(100000000),
            "triangle count: found 100000000 in a file of 284 bytes, expected 5000000084 bytes "
            "for them"},
        MeshCase{"more.stl", stl(2),
                 "end: found 100 bytes behind the counted triangles, expected none: the count or "
                 "the file is wrong"},
        MeshCase{"zeros.stl", std::string(284, '\0'), "found 0 triangles"},
        MeshCase{"ones.stl", std::string(284, '\xff'),
                 "triangle count: found 4294967295 in a file of 284 bytes"},
        MeshCase{"truncated.stl", stl().substr(0, 250), "triangle count: found 4 in a file of 250"},
        MeshCase{"header.stl", stl().substr(0, 60) + std::string(1, '\0'), "61 bytes"},
        MeshCase{"nan.stl", stl(4, {{0, 0, kNan}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
                 "triangle 0: found a coordinate of nan"},
        MeshCase{"inf.stl", stl(4, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, kInfinite}}),
                 "triangle 1: found a coordinate of inf"},
        MeshCase{"far.stl", stl(4, {{0, 0, 3e38f}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), "1 km"},
        MeshCase{"line.stl", stl(4, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), "any area"},
        MeshCase{"text_cut.stl", text_stl("1 0 0", ""),
                 "line 30: found the end of the file, expected facet or endsolid"},
        MeshCase{"text_nan.stl", text_stl("nan 0 0"), "line 6: found a coordinate of nan"},
        MeshCase{"text_large.stl", text_stl("1e400 0 0"), "line 6: found a coordinate of inf"},
        MeshCase{"text_word.stl", text_stl("one 0 0"), "line 6: found 'one', expected a number"},
        MeshCase{"text_comma.stl", text_stl("1,0 0 0"), "line 6: found '1,0', expected a number"},
        MeshCase{"text_corners.stl", replaced(text_stl(), "vertex 1 0 0\n", ""),
                 "line 2: found a face of 2 corners, expected 3 to 4096"},
        MeshCase{"text_keyword.stl", replaced(text_stl(), "outer loop", "outer lop"),
                 "line 3: found 'lop', expected loop"},
        MeshCase{"text_behind.stl", text_stl() + "facet normal 0 0 0",
                 "line 31: found 'facet', expected solid, or the end of the file"},
        MeshCase{"text_none.stl", "solid a\nendsolid a\n", "0 triangles"}),
    name_of);

TEST(ReadStl, CutAnywhereOrChangedAnywhereItIsAMeshOrRefused) {
  expect_damage_told("a.stl", stl(),
                     std::string("\0\xff"
                                 "9 ",
                                 4));
  expect_damage_told("a.stl", text_stl(),
                     std::string("\0\xff"
                                 "9 ",
                                 4));
  for (std::size_t at = 0; at < stl().size(); ++at) {
    EXPECT_FALSE(is_mesh_or_refused("a.stl", stl().substr(0, at))) << at;
  }
  const std::string text = text_stl();
  for (std::size_t at = 0; at < text.find("endsolid") + 8; ++at) {
    EXPECT_FALSE(is_mesh_or_refused("a.stl", text.substr(0, at))) << at;
  }
}

}  // namespace
}  // namespace sulcus::test::read_stl_test
