#include <filesystem>

#include <gtest/gtest.h>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::bad_input_test {
namespace {

using test::probe_scene;
using test::sulcus_command;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// One line, status 2, and all of what it must name; nothing written.
void expect_refused(const ScratchFolder& scratch, const std::string& arguments,
                    std::initializer_list<std::string> named) {
  const auto result = sulcus_command(arguments, scratch.path("err"));
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  for (const std::string& part : named) {
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " in " << result.err;
  }
}

struct BadScene {
  const char *name, *from, *to;
  std::initializer_list<std::string> named;
};

TEST(BadInput, ScenesAreRefusedWithPlaceFoundAndExpected) {
  const BadScene cases[] = {
      {"wrong key",
       "diameter_mm",
       "diametre_mm",
       {"s.toml", "line 9, column", "burr.diametre_mm", "'diameter_mm'"}},
      {"wrong type",
       "voxel_mm = 0.05",
       "voxel_mm = \"fine\"",
       {"line 4, column", "workpiece.voxel_mm", "fine", "a number"}},
      {"wrong range", "voxel_mm = 0.05", "voxel_mm = -1", {"workpiece.voxel_mm", "-1", "0.001 to"}},
      {"not finite", "voxel_mm = 0.05", "voxel_mm = nan", {"workpiece.voxel_mm", "nan"}},
      {"an array where a table is", "[burr]", "[[burr]]", {"line 8", "burr", "a table"}},
      {"unit in the key", "speed_mm_per_s", "speed_m_per_s", {"'speed_mm_per_s'"}},
      {"cells no multiple of 8",
       "[64, 64, 64]",
       "[64, 60, 64]",
       {"workpiece.cells", "60", "multiples of 8"}},
      {"more cells than there may be", "[64, 64, 64]", "[64, 64, 4096]", {"workpiece.cells"}},
      {"burr outside its field",
       "field = [48, 192, 48]",
       "field = [48, 192, 48]\nfield_spacing_mm = 0.005",
       {"field_spacing_mm", "at least"}},
      {"no TOML", "[burr]", "[burr", {"s.toml", "line 8, column"}},
      {"a missing file", "shape = \"box\"", "file = \"nowhere.nrrd\"", {"nowhere.nrrd"}},
      {"a start inside", "[-0.6, 0, 1.2]", "[0, 0, 0]", {"[trajectory]", "inside the tooth"}},
      {"an unknown table", "[trajectory]", "[haptic]\n[trajectory]", {"'haptic'", "'haptics'"}},
  };
  for (const BadScene& bad : cases) {
    SCOPED_TRACE(bad.name);
    const ScratchFolder scratch;
    const std::string scene = scratch.write("s.toml", replaced(probe_scene(), bad.from, bad.to));
    expect_refused(scratch, "run " + scene + " -o " + scratch.path("out"), bad.named);
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
  }
}

TEST(BadInput, FilesAreRefused) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", probe_scene());
  const auto run_with = [&](const std::string& file) {
    return "run " + scene + " --set workpiece.file=" + file + " -o " + scratch.path("out");
  };
  expect_refused(scratch, "run " + scratch.path("none.toml"), {"none.toml", "scene"});
  expect_refused(scratch, run_with(scratch.write("empty.stl", "")), {"empty.stl"});
  expect_refused(scratch, run_with(scratch.write("none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")),
                 {"none.obj", "triangles"});
  const std::string head = "NRRD0004\ntype: uint16\ndimension: 3\nencoding: raw\nendian: little\n";
  expect_refused(
      scratch,
      run_with(scratch.write("huge.nrrd", head + "sizes: 4000000000 4000000000 4000000000\n\n")),
      {"huge.nrrd"});
  expect_refused(scratch, run_with(scratch.write("cut.nrrd", head + "sizes: 64 64 64\n\nshort")),
                 {"cut.nrrd"});
  expect_refused(scratch, "replay --verify " + scratch.write("x.h5", "no recording"), {"x.h5"});
  expect_refused(scratch, "inspect " + scratch.path("nothing"), {"nothing"});
}

TEST(BadInput, UsageIsRefused) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", probe_scene());
  expect_refused(scratch, "", {"subcommand"});
  expect_refused(scratch, "run", {"SCENE"});
  expect_refused(scratch, "run " + scene + " --pace quick", {"--pace"});
  expect_refused(scratch, "run " + scene + " --set nonsense",
                 {"--set nonsense", "TABLE.KEY=VALUE"});
  expect_refused(scratch, "run " + scene + " --set tissue.gold.above=1", {"gold"});
  expect_refused(scratch, "run " + scene + " --duration -1", {"--duration"});
}

TEST(BadInput, WhatIsNoNumberIsRefusedByEveryOptionForOne) {
  const ScratchFolder scratch;
  for (const std::string option :
       {"run x.toml --duration=", "run x.toml --limit-gib=", "render x.h5 --fps=",
        "render x.h5 --stereo=", "render x.h5 --colour-by goal --scale=",
        "inspect x.nrrd --spacing-mm 1 1 ", "export x.h5 --mesh m.stl --simplify="}) {
    for (const char* number : {"nan", "inf"}) {
      SCOPED_TRACE(option + number);
      expect_refused(scratch, option + number, {number});
    }
  }
}

TEST(BadInput, KeysOfVolumesAreRefusedBesideAShapeOrAMesh) {
  const ScratchFolder scratch;
  const std::string run = "run " + scratch.write("s.toml", probe_scene()) + " -o " +
                          scratch.path("out") + " --set workpiece.";
  for (const std::string key :
       {"solid_above=3", "spacing_mm=[1,1,1]", "label=3", "box_mm=[0,0,0,1,1,1]"}) {
    expect_refused(scratch, run + key, {"[workpiece]", key.substr(0, key.find('=')), "a volume"});
  }
  scratch.write("cube.stl", "solid cube\nendsolid cube\n");  // is not read before they are
  const std::string mesh =
      scratch.write("m.toml", replaced(probe_scene(), "shape = \"box\"", "file = \"cube.stl\""));
  expect_refused(scratch,
                 "run " + mesh + " -o " + scratch.path("out") + " --set workpiece.solid_above=3",
                 {"[workpiece]", "solid_above for a mesh"});
  const std::string body =
      scratch.write("b.toml", probe_scene() +
                                  "[[body]]\nshape = \"box\"\nvoxel_mm = 0.05\n"
                                  "cells = [8, 8, 8]\nspacing_mm = [1, 1, 1]\n");
  expect_refused(scratch, "run " + body + " -o " + scratch.path("out"),
                 {"[[body]]", "spacing_mm for a built-in shape"});
  // Also where the solid is cached.
  const std::string cached = "SULCUS_CACHE=" + scratch.path("cache");
  const std::string whole = "run " + scratch.path("s.toml") + " -o " + scratch.path("whole");
  ASSERT_EQ(sulcus_command(whole, scratch.path("err"), cached).status, 0);
  EXPECT_EQ(sulcus_command(run + "label=3", scratch.path("err"), cached).status, 2);
}

TEST(BadInput, NothingAlreadyRecordedIsLost) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  const std::string out = scratch.path("out");
  ASSERT_EQ(sulcus_command("run " + scene + " -o " + out, scratch.path("err")).status, 0);
  const std::string before = test::read_file(out + "/recording.h5");
  expect_refused(scratch, "run " + scene + " -o " + out + " --set workpiece.cells=[1,2,3]",
                 {"cells"});
  EXPECT_EQ(test::read_file(out + "/recording.h5"), before);
}

TEST(BadInput, InspectReadsTheChangesOfASceneAsRunDoes) {
  ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", probe_scene());
  const auto changed =
      sulcus_command("inspect " + scene + " --set trajectory.speed_mm_per_s=2 --set title=changed",
                     scratch.path("err"));
  EXPECT_EQ(changed.status, 0) << changed.err;
  EXPECT_NE(changed.out.find("changed"), std::string::npos) << changed.out;
  expect_refused(scratch, "inspect " + scene + " --set burr.diametre_mm=1",
                 {"s.toml", "--set", "burr.diametre_mm", "'diameter_mm'"});
  expect_refused(scratch, "inspect " + scratch.write("m.stl", "") + " --set burr.diameter_mm=1",
                 {"m.stl", "--set", "no scene"});
}

}  // namespace
}  // namespace sulcus::bad_input_test
