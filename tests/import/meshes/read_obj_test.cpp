#include <string>

#include <gtest/gtest.h>

#include "tests/import/small_meshes.hpp"

namespace sulcus::test::read_obj_test {
namespace {

class ObjRead : public testing::TestWithParam<MeshCase> {};
class ObjRefused : public testing::TestWithParam<MeshCase> {};

TEST_P(ObjRead, IsTheTetrahedron) {
  const ScratchFolder folder;
  expect_tetrahedron(read_mesh(folder.write(GetParam().name, GetParam().contents)));
}

TEST_P(ObjRefused, InOneLine) { expect_refused(GetParam()); }

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string kNormals = "vt 0 0\nvn 0 0 1\n";

INSTANTIATE_TEST_SUITE_P(
    ReadObj, ObjRead,
    testing::Values(
        MeshCase{"plain.obj", obj(), ""},
        MeshCase{"texture.obj",
                 obj("vt 0 0\nf 1/1 3/1 2/1\nf 1/1 2/1 4/1\nf 1/1 4/1 3/1\nf 2/1 3/1 4/1\n"), ""},
        MeshCase{"normals.obj",
                 obj("vn 0 0 1\nf 1//1 3//1 2//1\nf 1//1 2//1 4//1\nf 1//1 4//1 3//1\nf 2//1 3//1 "
                     "4//1\n"),
                 ""},
        MeshCase{"both.obj",
                 obj(kNormals + "f 1/1/1 3/1/1 2/1/1\nf 1/1/1 2/1/1 4/1/1\nf 1/-1/-1 4/1/1 "
                                "3/1/1\nf 2/1/1 3/1/1 4/1/1\n"),
                 ""},
        MeshCase{"empty_indices.obj", obj("f 1/ 3// 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"), ""},
        MeshCase{"negative.obj", obj("f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n"), ""},
        MeshCase{"negative_between.obj",
                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 -1\nf 1 -1 3\nf -3 -2 -1\n",
                 ""},
        MeshCase{"ahead.obj", "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n" + kVertices, ""},
        MeshCase{"comments.obj",
                 "# a comment \\\n#\nv 0 0 9 # (\n" +
                     obj("f 2 4 3 # behind a face\nf 2 3 5#at once\nf 2 5 4\t# 7 8 9 \\\n"
                         "f 3 4 5\n"),
                 ""},
        MeshCase{"blanks.obj", replaced(replaced(obj(), "v ", " \tv  "), "f ", "\t f\t"), ""},
        MeshCase{"blanks_behind.obj", replaced(obj(), "\n", " \t\n\n"), ""},
        MeshCase{"continued.obj", obj("f 1 \\\n3 \\\r\n 2\nf 1 2\\\n 4\nf 1 4 3\nf 2 3 4 \\\n"),
                 ""},
        MeshCase{"windows.obj", replaced(obj(), "\n", "\r\n"), ""},
        MeshCase{"old_mac.obj", replaced(obj(), "\n", "\r"), ""},
        MeshCase{"mark.obj", "\xef\xbb\xbf" + obj(), ""},
        MeshCase{"weights.obj",
                 replaced(kVertices, "\n", " 1.0\n") + obj().substr(kVertices.size()), ""},
        MeshCase{"colours.obj",
                 replaced(kVertices, "\n", " 0.5 0.25 1\n") + obj().substr(kVertices.size()), ""},
        MeshCase{"colours_alpha.obj",
                 replaced(kVertices, "\n", " 0.5 0.25 1 0.7\n") + obj().substr(kVertices.size()),
                 ""},
        MeshCase{"exponents.obj", obj().replace(8, 8, "v +1.0E+0 0e0 -.0\n"), ""},
        MeshCase{
            "names.obj",
            "mtllib a#b c.mtl\no Zahn \xc3\xa4\xe2\x82\xac\ng left upper\nusemtl none\ns off\n" +
                obj(),
            ""},
        MeshCase{"lines.obj", obj() + "p 1 2\nl 1 2 3\nvp 0.1 0.2\n", ""},
        MeshCase{"curves.obj",
                 obj() + "cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4 \\\n\nparm u 0 1\nend\n", ""},
        MeshCase{"no_last_end.obj", obj("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4"), ""},
        MeshCase{"old_name.obj", replaced(obj(), "f ", "fo "), ""},
        MeshCase{"parts.obj", obj() + times(70000, "g a\n"), ""}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    ReadObj, ObjRefused,
    testing::Values(
        MeshCase{"range.obj", obj("f 1 2 3\nf 1 2 9\nf 1 2 4\nf 2 3 4\n"),
                 "line 6: found vertex 9, expected 1 to 4 or -1 to -4"},
        MeshCase{"zero.obj", obj("f 0 2 1\n"),
                 "line 5: found vertex 0, expected 1 to 4 or -1 to -4"},
        MeshCase{"negative.obj", obj("f 1 2 -5\n"), "line 5: found vertex -5"},
        MeshCase{"huge.obj", obj("f 1 2 4294967297\n"), "line 5: found vertex 4294967297"},
        MeshCase{"word.obj", obj("f 1 2 three\n"), "line 5: found 'three', expected a corner"},
        MeshCase{"slashes.obj", obj("f 1 2 3/1/1/1\n"),
                 "line 5: found '3/1/1/1', expected a corner"},
        MeshCase{"points.obj", obj(""), "found 0 triangles"},
        MeshCase{"corners.obj", obj("f 1 3 2\nf 1 2\n"),
                 "line 6: found a face of 2 corners, expected 3 to 4096"},
        MeshCase{"commented.obj", obj("f 1 3 # 2\n"), "line 5: found a face of 2 corners"},
        MeshCase{"none.obj", obj("f\n"), "line 5: found a face of 0 corners, expected 3 to 4096"},
        MeshCase{"polygon.obj", obj("f" + times(5000, " 1") + "\n"),
                 "line 5: found a face of 5000 corners, expected 3 to 4096"},
        MeshCase{"polygon_lines.obj", obj("f" + times(5000, " \\\n1") + "\n"),
                 "line 5: found a face of 5000 corners"},
        MeshCase{"nan.obj", obj("f 1 3 2\n", "nan"), "line 2: found a coordinate of nan"},
        MeshCase{"inf.obj", obj("f 1 3 2\n", "-inf"), "line 2: found a coordinate of -inf"},
        MeshCase{"two.obj", "v 1 2\n", "line 1: found a vertex of 2 numbers, expected 3"},
        MeshCase{"five.obj", "v 1 2 3 4 5\n", "line 1: found a vertex of 5 numbers"},
        MeshCase{"nine.obj", "v 1 2 3 4 5 6 7 8 9\n", "line 1: found '9', expected 8 numbers"},
        MeshCase{"weight.obj", "v 1 2 3 0.5\n", "line 1: found a weight of 0.5"},
        MeshCase{"number.obj", "v 1 2 3x\n", "line 1: found '3x', expected a number"},
        MeshCase{"surface.obj", obj() + "surf 0 1 0 1 1 2 3 4\n",
                 "line 9: found 'surf', expected a surface of polygons"},
        MeshCase{"call.obj", obj() + "call other.obj\n", "line 9: found 'call'"},
        MeshCase{"unknown.obj", obj() + "ff 1 2 3\n", "line 9: found 'ff', expected a statement"},
        MeshCase{"drawing.obj", "0\nSECTION\n2\nHEADER\n0\nENDSEC\n",
                 "line 1: found '0', expected a statement of OBJ"},
        MeshCase{"zeros.obj", obj() + std::string(100, '\0'), "line 9: found"}),
    name_of);

TEST(ReadObj, CutAnywhereOrChangedAnywhereItIsAMeshOrRefused) {
  const std::string file = "# a\nmtllib x\nv 0 0 0 1\nv 1 0 0 .1 .2 .3\nv 0 1 0\nv 0 0 1 # b\n" +
                           kNormals + "f 1/1 3 -3\nf 1//1 2/1/1 \\\n4\nf 1 4 3\nf 2 3 4\n";
  expect_damage_told("a.obj", file,
                     std::string("\0\xff"
                                 "9\n\\",
                                 5));
}

}  // namespace
}  // namespace sulcus::test::read_obj_test
