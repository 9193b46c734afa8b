#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/scene_text.hpp"

// [[tissue]] file: a surface of its own beside the workpiece's.

namespace sulcus::tissue_file_test {
namespace {

using test::error_of, test::parse;

/// A scene whose workpiece says `solid`, of enamel and of dentine that says `keys` from line 8 on.
std::string with_dentine(const std::string& solid, const std::string& keys) {
  return "[workpiece]\n" + solid +
         "\n[trajectory]\npoints_mm = [[0, 0, 9]]\n[[tissue]]\nname = 'enamel'\n"
         "[[tissue]]\nname = 'dentine'\n" +
         keys;
}

const std::string kMesh = "file = 'tooth.stl'";

TEST(TissueFile, IsRelativeToTheSceneOrToTheCurrentFolder) {
  const Scene s = parse(with_dentine(kMesh, "file = 'inner/dentine.ply'\n"));
  EXPECT_EQ(s.tissues[0].file, "");
  EXPECT_EQ(s.tissues[1].file, "/scenes/inner/dentine.ply");
  const Scene set = parse(with_dentine(kMesh, "file = 'a.stl'\n"), {"tissue.dentine.file=b.stl"});
  EXPECT_EQ(set.tissues[1].file, (std::filesystem::current_path() / "b.stl").string());
}

TEST(TissueFile, StandsBesideAMeshOnly) {
  const std::string file = "file = 'dentine.stl'\n";
  EXPECT_EQ(error_of(with_dentine("shape = 'molar'", file)),
            "/scenes/s.toml: line 9, column 8, tissue.file: found a file beside a workpiece that "
            "is a shape, expected a mesh of both");
  EXPECT_EQ(error_of(with_dentine("file = 'tooth.nrrd'", file)),
            "/scenes/s.toml: line 9, column 8, tissue.file: found a file beside a workpiece that "
            "is a volume, expected above, or a mesh of both");
  EXPECT_EQ(error_of(with_dentine(kMesh, file)), "no error");
}

TEST(TissueFile, OneWayOnlyAndAMesh) {
  EXPECT_EQ(error_of(with_dentine(kMesh, "above = 900\nfile = 'dentine.stl'\n")),
            "/scenes/s.toml: line 10, column 8, tissue.file: found both above and a file, expected "
            "one of them");
  EXPECT_EQ(error_of(with_dentine(kMesh, "file = 'dentine.nrrd'\n")),
            "/scenes/s.toml: line 9, column 8, tissue.file: found no mesh ('dentine.nrrd'), "
            "expected .stl, .obj or .ply");
  EXPECT_EQ(error_of(with_dentine(kMesh, ""), {"tissue.enamel.file=/a.stl"}),
            "/scenes/s.toml: --set tissue.file: found a file of the first "
            "tissue, expected none: workpiece.file is its surface");
}

}  // namespace
}  // namespace sulcus::tissue_file_test
