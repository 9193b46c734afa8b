#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/import/small_meshes.hpp"

namespace sulcus::test::read_ply_test {
namespace {

/// Writes the tetrahedron as PLY of whatever types.
struct PlyWriter {
  std::string encoding = "binary_little_endian";
  std::string coordinate = "float", count = "uchar", index = "int";
  std::string list = "vertex_indices";
  // Properties of a type around those of the mesh, each "TYPE NAME" of the number 7 or
  // "list uchar TYPE NAME" of two of them.
  std::vector<std::string> before_x = {}, behind_z = {}, before_list = {}, behind_list = {};
  bool faces_first = false, edges = false;

  std::string file() const {
    std::string header = "ply\nformat " + encoding + " 1.0\n", rows;
    for (const bool faces : {faces_first, !faces_first}) {
      if (faces) {
        header += "element face 4\n" + properties(before_list) + "property list " + count + " " +
                  index + " " + list + "\n" + properties(behind_list);
        for (const Triangle& t : kTriangles) {
          std::string row = extras(before_list) + number(3, count);
          for (const int v : t) row += number(v, index);
          rows += row + extras(behind_list) + row_end();
        }
      } else {
        header += "element vertex 4\n" + properties(before_x);
        for (const char* axis : {" x\n", " y\n", " z\n"}) header += "property " + coordinate + axis;
        header += properties(behind_z);
        for (const Corner& c : kCorners) {
          rows += extras(before_x);
          for (const float x : c) rows += number(x, coordinate);
          rows += extras(behind_z) + row_end();
        }
      }
      if (edges && faces == faces_first) {
        header += "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
        for (int e = 0; e < 2; ++e) rows += number(e, "int") + number(2, "int") + row_end();
      }
    }
    return header + "end_header\n" + rows;
  }

 private:
  static std::string properties(const std::vector<std::string>& extra) {
    std::string lines;
    for (const std::string& property : extra) lines += "property " + property + "\n";
    return lines;
  }
  std::string extras(const std::vector<std::string>& extra) const {
    std::string numbers;
    for (const std::string& property : extra) {
      if (property.starts_with("list uchar ")) {
        const std::string type = property.substr(11, property.find(' ', 11) - 11);
        numbers += number(2, "uchar") + number(7, type) + number(7, type);
      } else {
        numbers += number(7, property.substr(0, property.find(' ')));
      }
    }
    return numbers;
  }
  std::string row_end() const { return encoding == "ascii" ? "\n" : ""; }
  std::string number(double value, const std::string& type) const {
    if (encoding == "ascii") return std::to_string(static_cast<int>(value)) + " ";
    std::string bytes;
    if (type == "char" || type == "int8") bytes = bytes_of(static_cast<std::int8_t>(value));
    if (type == "uchar" || type == "uint8") bytes = bytes_of(static_cast<std::uint8_t>(value));
    if (type == "short" || type == "int16") bytes = bytes_of(static_cast<std::int16_t>(value));
    if (type == "ushort" || type == "uint16") bytes = bytes_of(static_cast<std::uint16_t>(value));
    if (type == "int" || type == "int32") bytes = bytes_of(static_cast<std::int32_t>(value));
    if (type == "uint" || type == "uint32") bytes = bytes_of(static_cast<std::uint32_t>(value));
    if (type == "float" || type == "float32") bytes = bytes_of(static_cast<float>(value));
    if (type == "double" || type == "float64") bytes = bytes_of(value);
    EXPECT_FALSE(bytes.empty()) << type;
    if (encoding == "binary_big_endian") std::ranges::reverse(bytes);
    return bytes;
  }
};

const std::vector<std::string> kEncodings = {"ascii", "binary_little_endian", "binary_big_endian"};

void expect_read(const std::string& contents) {
  const ScratchFolder folder;
  expect_tetrahedron(read_mesh(folder.write("a.ply", contents)));
}

TEST(ReadPly, EveryEncodingAndTypeByItsOldAndNewName) {
  const std::vector<std::string> whole = {"char",   "int8",   "uchar", "uint8", "short", "int16",
                                          "ushort", "uint16", "int",   "int32", "uint",  "uint32"};
  std::vector<std::string> all = whole;
  all.insert(all.end(), {"float", "float32", "double", "float64"});
  for (const std::string& encoding : kEncodings) {
    for (const std::string& type : all) {
      SCOPED_TRACE(encoding + " " + type);
      expect_read(PlyWriter{.encoding = encoding, .coordinate = type}.file());
    }
    for (const std::string& type : whole) {
      SCOPED_TRACE(encoding + " " + type);
      expect_read(PlyWriter{.encoding = encoding, .count = type, .index = type}.file());
    }
  }
}

TEST(ReadPly, OtherElementsAndPropertiesAroundAnyOrder) {
  for (const std::string& encoding : kEncodings) {
    SCOPED_TRACE(encoding);
    expect_read(PlyWriter{.encoding = encoding, .list = "vertex_index"}.file());
    expect_read(PlyWriter{.encoding = encoding,
                          .before_x = {"uchar flags", "list uchar double weights"},
                          .behind_z = {"float nx", "float ny", "float nz", "uchar red"},
                          .before_list = {"list uchar float texcoord", "short texnumber"},
                          .behind_list = {"list uchar float more", "uchar green"}}
                    .file());
    expect_read(PlyWriter{.encoding = encoding, .faces_first = true, .edges = true}.file());
  }
}

TEST(ReadPly, HeadersOfEveryKind) {
  for (const std::string& encoding : kEncodings) {
    SCOPED_TRACE(encoding);
    const std::string file = PlyWriter{.encoding = encoding}.file();
    const std::size_t rows = file.find("end_header\n") + 11;
    const std::string header = file.substr(0, rows), rest = file.substr(rows);
    for (std::size_t line = header.find('\n') + 1; line < header.size();
         line = header.find('\n', line) + 1) {
      std::string commented = header;
      commented.insert(line, "comment\ncomment element vertex 9\nobj_info num_cols 3\n\n");
      expect_read(commented + rest);
    }
    expect_read(replaced(header, "\n", "\r\n") + rest);
    expect_read(replaced(header, "\n", "\r") + rest);
    expect_read(replaced(replaced(header, " ", " \t "), "\n", " \n") + rest);
    expect_read(replaced(header, "end_header", "comment\relement vertex 9\nend_header") + rest);
    expect_read("\xef\xbb\xbf" + file);
  }
  const std::string text = ply(false);
  expect_read(replaced(text, "\n", "\r\n"));
  expect_read(replaced(text, "\n", "\r"));
  expect_read(replaced(text, "1.0", "+1.0E+00"));
  expect_read(text.substr(0, text.size() - 1));
  expect_read(text + "\n \n");
  expect_read(ply(true) + std::string(5, '\0') + "\n");
}

TEST(ReadPly, TheFirstByteOfTheDataMayEndALine) {
  for (const char first : {'\n', '\r'}) {
    std::string file = ply(true);
    const std::size_t x = file.find("end_header\n") + 11;
    file.replace(x, 1, 1, first);  // 1e-44 mm
    expect_read(file);
    expect_read(replaced(file.substr(0, x), "\n", "\r\n") + file.substr(x));
    expect_read(replaced(file.substr(0, x), "\n", "\r") + file.substr(x));
  }
}

/// 2 x 2 x 2 mm of six quadrilaterals: the polygons are there too.
TEST(ReadPly, PolygonsAndStrips) {
  const ScratchFolder folder;
  const std::string vertices = "0 0 0\n2 0 0\n0 2 0\n2 2 0\n0 0 2\n2 0 2\n0 2 2\n2 2 2\n";
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n"
      "property float y\nproperty float z\n";
  const TriangleMesh polygons = read_mesh(folder.write(
      "a.ply", head + "element face 6\nproperty list uchar uint vertex_index\nend_header\n" +
                   vertices +
                   "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n"));
  EXPECT_EQ(polygons.triangles.size(), 12u);
  EXPECT_NEAR(enclosed_volume(polygons), 8e-9, 1e-14);
  // Around the four sides, then bottom and top.
  const TriangleMesh strips = read_mesh(folder.write(
      "b.ply", head + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                   vertices + "20 0 4 2 6 3 7 1 5 0 4 -1 0 2 1 3 -1 4 5 6 7\n"));
  EXPECT_EQ(strips.triangles.size(), 12u);
  EXPECT_NEAR(std::abs(enclosed_volume(strips)), 8e-9, 1e-14);
}

TEST(ReadPly, FilesThatWereReadWronglyOnce) {
  const std::string cases = SULCUS_SOURCE_DIR "/../shared/cases/";
  if (!std::filesystem::exists(cases)) GTEST_SKIP() << "no " << cases;
  for (const char* name : {"first_byte_0a.ply", "comment_after_x.ply"}) {
    EXPECT_NEAR(enclosed_volume(read_mesh(cases + name)), 249.443e-9, 1e-12) << name;
  }
  EXPECT_NEAR(enclosed_volume(read_mesh(cases + "comment_among.ply")), 48e-9, 1e-12);
}

/// A text PLY whose first face is `corners`.
std::string with_a_face_of(const std::string& corners) {
  return replaced(ply(false), "3 0 2 1", corners);
}

class PlyRefused : public testing::TestWithParam<MeshCase> {};

TEST_P(PlyRefused, InOneLine) { expect_refused(GetParam()); }

std::string with_nan(int vertex) {
  std::string file = ply(true);
  const auto at = file.find("end_header\n") + 11 + 12 * static_cast<std::size_t>(vertex);
  return file.replace(at, 4, bytes_of(std::numeric_limits<float>::quiet_NaN()));
}

INSTANTIATE_TEST_SUITE_P(
    ReadPly, PlyRefused,
    testing::Values(
        MeshCase{"truncated.ply", ply(true, 4, 4, 3, 20), "face 2: found the end of the file"},
        MeshCase{"truncated_text.ply", ply(false, 4, 4, 3, 9), "face 3: found the end"},
        MeshCase{"vertices.ply", ply(true, 4000000000),
                 "header: found 4000000000 rows of element vertex in a file of 278 bytes, expected "
                 "no more than it can hold"},
        MeshCase{"faces.ply", ply(false, 4, 400), "found 400 rows of element face in a file of"},
        MeshCase{"five.ply", ply(false, 4, 5),
                 "face 4: found the end of the file, expected 5 rows"},
        MeshCase{"three.ply", ply(false, 4, 3),
                 "end: found '3' behind the last row of the header, expected none: a count or the "
                 "file is wrong"},
        MeshCase{"three_binary.ply", ply(true, 4, 3), "end: found 13 bytes behind the last row"},
        MeshCase{"range.ply", ply(true, 4, 4, 9),
                 "face 3: found vertex 9, expected an index below 4"},
        MeshCase{"range_text.ply", ply(false, 4, 4, 99), "face 3: found vertex 99"},
        MeshCase{"negative.ply", ply(true, 4, 4, -1), "face 3: found vertex -1"},
        MeshCase{"nan.ply", with_nan(2), "vertex 2: found a coordinate of nan"},
        MeshCase{"corners.ply", with_a_face_of("0"),
                 "face 0: found a face of 0 corners, expected 3 to 4096"},
        MeshCase{"polygon.ply", with_a_face_of("5000" + times(5000, " 1")),
                 "face 0: found a face of 5000 corners, expected 3 to 4096"},
        MeshCase{
            "length.ply",
            PlyWriter{.count = "char"}.file().replace(PlyWriter{.count = "char"}.file().size() - 13,
                                                      1, "\xff"),
            "face 3: found -1"},
        MeshCase{"nothing.ply",
                 replaced(ply(false), "element face", "element nothing 4000000000\nelement face"),
                 "header: found element nothing without properties, expected at least one"},
        MeshCase{
            "twice.ply",
            replaced(ply(false), "element face", "element vertex 4\nproperty char c\nelement face"),
            "line 7: found element vertex twice, expected it once"},
        MeshCase{"twice_x.ply", replaced(ply(false), "float y", "float x"),
                 "line 5: found property x twice, expected it once"},
        MeshCase{"no_z.ply", replaced(ply(false), "float z", "float w"),
                 "found vertices without x, y and z"},
        MeshCase{"no_list.ply", replaced(ply(false), "vertex_indices", "corners"),
                 "found element face without vertex_indices"},
        MeshCase{"no_face.ply", replaced(ply(false), "element face", "element facet"),
                 "found no element face"},
        MeshCase{"no_format.ply", replaced(ply(false), "format ascii 1.0\n", ""),
                 "found no format"},
        MeshCase{"format.ply", replaced(ply(false), "ascii", "binary_middle_endian"),
                 "line 2: found \"format binary_middle_endian 1.0\""},
        MeshCase{"type.ply", replaced(ply(false), "float x", "real x"),
                 "line 4: found type \"real\""},
        MeshCase{"control.ply", replaced(ply(false), "3 0 2 1", "3 0 2\x10 1"), "face 0: found '2"},
        MeshCase{"return.ply", replaced(ply(false), "float x\n", "float x\rcomment\n"),
                 "line 4: found \"property float x comment\", expected lines that end"},
        MeshCase{"unknown.ply", replaced(ply(false), "end_header", "texture\nend_header"),
                 "line 9: found \"texture\", expected a line of a PLY header"},
        MeshCase{"two_lines.ply", replaced(ply(false), "3 0 2 1", "3 0 2\n1"),
                 "face 0: found the end of the line, expected 4 rows as the header says"},
        MeshCase{"one_line.ply", replaced(ply(false), "3 0 2 1", "3 0 2 1 7"),
                 "face 0: found '7', expected the end of the row"},
        MeshCase{"fraction.ply", replaced(ply(false), "3 0 2 1", "3 0 2.5 1"),
                 "face 0: found '2.5', expected 4 rows as the header says"},
        MeshCase{"float_index.ply", replaced(ply(false), "uchar int", "uchar float"),
                 "header: found indices that are no whole numbers, expected int or uint"},
        MeshCase{"float_count.ply", replaced(ply(false), "uchar int", "float int"),
                 "line 8: found lists of float lengths, expected whole numbers"},
        MeshCase{"header.ply", "ply\nformat ascii 1.0\n", "no end_header"},
        MeshCase{"word.ply", "hello\n", "\"ply\""}, MeshCase{"start.ply", "plywood\n", "\"ply\""}),
    name_of);

TEST(ReadPly, WhatNoFaceRefersToMayBeNoNumber) {
  const std::string file = replaced(ply(false), "vertex 4", "vertex 5");
  const std::size_t faces = file.find("3 0 2 1");
  expect_read(std::string(file).insert(faces, "nan nan nan\n"));
}

TEST(ReadPly, CutAnywhereOrChangedAnywhereItIsAMeshOrRefused) {
  for (const std::string& encoding : kEncodings) {
    SCOPED_TRACE(encoding);
    const std::string file = PlyWriter{.encoding = encoding,
                                       .count = "int",
                                       .behind_z = {"list uchar short weights"},
                                       .behind_list = {"list uchar double texcoord"}}
                                 .file();
    expect_damage_told("a.ply", file,
                       std::string("\0\xff"
                                   "9\n",
                                   4));
    // A text may lack the end of its last line.
    for (std::size_t at = 0; at < file.find_last_not_of(" \n"); ++at) {
      EXPECT_FALSE(is_mesh_or_refused("a.ply", file.substr(0, at))) << at;
    }
  }
}

}  // namespace
}  // namespace sulcus::test::read_ply_test
