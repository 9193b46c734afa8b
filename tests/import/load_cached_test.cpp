#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/input_files.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/import/volumes/write_volume.hpp"
#include "tests/import/mesh_fixtures.hpp"
#include "tests/support/scratch_folder.hpp"

// The loaders with the load cache: what comes from it is what would have been made.

namespace sulcus::load_cached_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;
using Change = std::pair<const char*, std::function<void(Scene&)>>;

TissueSettings tissue(const char* name, std::optional<double> above = {}) {
  TissueSettings settings;
  settings.name = name;
  settings.above = above;
  return settings;
}

Scene shape_scene() {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kMolar;
  scene.workpiece.voxel_m = 0.3e-3;
  scene.workpiece.cells = Vector3i(48, 40, 64);
  scene.tissues = {tissue("enamel"), tissue("dentine"), tissue("pulp")};
  scene.burr.field_samples = Vector3i(16, 64, 16);
  return scene;
}

Scene file_scene(const std::string& file) {
  Scene scene;
  scene.workpiece.file = file;
  scene.workpiece.voxel_m = 0.1e-3;
  scene.workpiece.cells = Vector3i(40, 40, 40);
  scene.tissues = {tissue("enamel")};
  return scene;
}

void expect_equal(const VoxelModel& a, const VoxelModel& b) {
  EXPECT_EQ(a.clipped, b.clipped);
  ASSERT_EQ(a.leaves, b.leaves);
  ASSERT_EQ(a.tissues == nullptr, b.tissues == nullptr);
  ASSERT_EQ(a.fills.has_value(), b.fills.has_value());
  for (std::uint32_t v = 0; v < a.grid.cell_count(); ++v) {
    const Cell c = a.grid.cell_of_linear(v);
    if (a.solid(c)) {
      ASSERT_EQ(a.level(c), b.level(c)) << v;
      ASSERT_EQ(a.tissue(c), b.tissue(c)) << v;
    }
  }
}

bool is_hit(const Scene& scene, LoadCache& cache) {
  const int before = cache.hits();
  build_workpiece(scene, &cache);
  return cache.hits() > before;
}

void expect_hit_equals_miss(const Scene& scene, LoadCache& cache) {
  const VoxelModel plain = build_workpiece(scene);
  expect_equal(plain, build_workpiece(scene, &cache));
  const int before = cache.hits();
  expect_equal(plain, build_workpiece(scene, &cache));
  EXPECT_EQ(cache.hits(), before + 1);
}

void expect_each_misses(const Scene& scene, LoadCache& cache, const std::vector<Change>& changes) {
  EXPECT_TRUE(is_hit(scene, cache));
  for (const auto& [what, change] : changes) {
    Scene other = scene;
    change(other);
    EXPECT_FALSE(is_hit(other, cache)) << what;
  }
  EXPECT_TRUE(is_hit(scene, cache));
}

std::string ball_volume(const ScratchFolder& scratch, const std::string& name, double radius) {
  VoxelModel model;
  model.grid = {Vector3i(32, 32, 32), 0.1e-3};
  model.leaves.resize(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if ((c.cast<double>() - model.grid.origin_index()).norm() < radius) model.set(c, true);
  }
  write_volume(scratch.path(name), model, VolumeContent::kMask);
  return scratch.path(name);
}

TEST(LoadCached, ABuiltInShapeIsTheSame) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  const Scene scene = shape_scene();
  expect_hit_equals_miss(scene, cache);
  expect_each_misses(scene, cache,
                     {{"shape", [](Scene& s) { s.workpiece.shape = ShapeKind::kSphere; }},
                      {"cells", [](Scene& s) { s.workpiece.cells.x() = 56; }},
                      {"voxel", [](Scene& s) { s.workpiece.voxel_m = 0.31e-3; }},
                      {"position", [](Scene& s) { s.workpiece.position_m.z() = 1e-4; }},
                      {"rotation", [](Scene& s) { s.workpiece.rotation.x() = 0.1; }},
                      {"caries", [](Scene& s) { s.workpiece.molar_caries_radius_m = 1e-3; }},
                      {"tissues", [](Scene& s) { s.tissues.pop_back(); }},
                      {"their order", [](Scene& s) { std::swap(s.tissues[0], s.tissues[1]); }}});
  Scene felt = scene;  // what is felt of a tissue is not in the voxels
  felt.tissues[0].stiffness_N_per_m *= 2.0;
  EXPECT_TRUE(is_hit(felt, cache));
}

TEST(LoadCached, WhereTheFileLiesAndWhatIsSaidOfItComeFromTheCacheToo) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  Scene scene = file_scene(ball_volume(scratch, "v.nrrd", 10.0));
  scene.workpiece.labels = ball_volume(scratch, "l.nrrd", 8.0);
  scene.workpiece.label = 1;
  ImportNotes made, kept;
  build_workpiece(scene, &cache, &made);
  const VoxelModel model = build_workpiece(scene, &cache, &kept);
  EXPECT_EQ(cache.hits(), 1);
  ASSERT_TRUE(made.input && kept.input);
  EXPECT_EQ(made.input->sizes, Vector3i(32, 32, 32));
  EXPECT_EQ(made.input->numbers(), kept.input->numbers());
  ball_volume(scratch, "l.nrrd", 6.0);
  EXPECT_LT(build_workpiece(scene, &cache).solid_count(), model.solid_count());

  scene.workpiece.labels.clear();
  scene.workpiece.label.reset();
  scene.workpiece.solid_above.reset();
  write_volume(scene.workpiece.file, model, VolumeContent::kMask);
  scene.tissues = {{.name = "a", .above = {}, .label = 2}};
  EXPECT_THROW(build_workpiece(scene, &cache), InputError);  // there is only 1
}

TEST(LoadCached, AVolumeIsTheSameUntilItsContentsChange) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  const Scene scene = file_scene(ball_volume(scratch, "v.nrrd", 10.0));
  expect_hit_equals_miss(scene, cache);
  expect_each_misses(
      scene, cache,
      {{"solid_above", [](Scene& s) { s.workpiece.solid_above = 0.5; }},
       {"spacing", [](Scene& s) { s.workpiece.spacing_m = Vector3d::Constant(0.11e-3); }},
       {"position", [](Scene& s) { s.workpiece.position_m.x() = 1e-4; }},
       {"box",
        [](Scene& s) {
          s.workpiece.box_file = Eigen::AlignedBox3d(Vector3d::Constant(-1e-3), Vector3d::Zero());
        }},
       {"label", [](Scene& s) { s.workpiece.label = 1; }},
       {"tissue's label", [](Scene& s) { s.tissues[0].label = 1; }},
       {"tissues", [](Scene& s) {
          s.tissues = {tissue("enamel", 0.5), tissue("dentine")};
        }}});
  Scene moved = scene;
  moved.workpiece.file = scratch.path("elsewhere.nrrd");
  std::filesystem::copy_file(scene.workpiece.file, moved.workpiece.file);
  EXPECT_TRUE(is_hit(moved, cache)) << "the contents count, not the name";
  ball_volume(scratch, "v.nrrd", 11.0);
  EXPECT_FALSE(is_hit(scene, cache));
  expect_equal(build_workpiece(scene), build_workpiece(scene, &cache));
}

TEST(LoadCached, ADetachedHeadersDataCountAsItsContents) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  std::string grey(16 * 16 * 16, '\0');
  for (int v = 0; v < 4096; ++v) {
    const Vector3d p(v % 16 - 7.5, v / 16 % 16 - 7.5, v / 256 - 7.5);
    grey[static_cast<std::size_t>(v)] = p.norm() < 5.0 ? 1 : 0;
  }
  scratch.write("grey.raw", grey);
  const Scene mhd = file_scene(
      scratch.write("v.mhd",
                    "ObjectType = Image\nNDims = 3\nDimSize = 16 16 16\nElementType = MET_UCHAR\n"
                    "ElementSpacing = 0.1 0.1 0.1\nElementDataFile = grey.raw\n"));
  const Scene nhdr = file_scene(
      scratch.write("v.nhdr",
                    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nspacings: 0.1 0.1 0.1\n"
                    "encoding: raw\ndata file: grey.raw\n"));
  for (const Scene& scene : {mhd, nhdr}) {
    EXPECT_FALSE(is_hit(scene, cache));
    EXPECT_TRUE(is_hit(scene, cache));
  }
  grey[2000] = 0;
  grey[2056] = static_cast<char>(1 - grey[2056]);
  scratch.write("grey.raw", grey);
  for (const Scene& scene : {mhd, nhdr}) EXPECT_FALSE(is_hit(scene, cache));
}

TEST(HashInput, TellsWhatAReaderWouldTell) {
  const ScratchFolder scratch;
  const auto hash = [](const std::string& path) { return hash_input(path); };
  const std::string a = scratch.write("s/1.dcm", "one");
  scratch.write("s/2.dcm", "two");
  const auto folder = hash(scratch.path("s"));
  ASSERT_TRUE(folder);
  EXPECT_EQ(folder, hash(scratch.path("s")));
  scratch.write("s/2.dcm", "TWO");
  EXPECT_NE(folder, hash(scratch.path("s"))) << "a slice";
  scratch.write("s/2.dcm", "two");
  EXPECT_EQ(folder, hash(scratch.path("s")));
  std::filesystem::rename(a, scratch.path("s/3.dcm"));
  EXPECT_NE(folder, hash(scratch.path("s"))) << "the order of slices";

  EXPECT_NE(hash(scratch.write("a.stl", "x")), hash(scratch.write("a.ply", "x"))) << "the format";
  const std::string header = scratch.write("n.hdr", "h");
  scratch.write("n.img", "one");
  const auto pair = hash(header);
  EXPECT_TRUE(pair);
  scratch.write("n.img", "two");
  EXPECT_NE(pair, hash(header));

  EXPECT_FALSE(hash(scratch.path("none.nrrd")));
  EXPECT_FALSE(hash(scratch.write("l.nhdr", "NRRD0004\ndata file: LIST\na.raw\nb.raw\n")));
  EXPECT_FALSE(hash(scratch.write("p.mhd", "NDims = 3\nElementDataFile = s%03d.raw 1 10 1\n")));
  EXPECT_TRUE(hash(scratch.write("m.mha", "NDims = 3\nElementDataFile = LOCAL\n\x01\x02")));
}

TEST(LoadCached, AMeshIsTheSameUntilItsContentsChange) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  TriangleMesh mesh = icosphere(2);
  scale(mesh, 1.5e-3f);
  write_mesh(scratch.path("m.stl"), mesh);
  const Scene scene = file_scene(scratch.path("m.stl"));
  expect_hit_equals_miss(scene, cache);
  scale(mesh, 1.1f);
  write_mesh(scratch.path("m.stl"), mesh);
  EXPECT_FALSE(is_hit(scene, cache));
}

TEST(LoadCached, TheMeshesOfTissuesCountByTheirContents) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  TriangleMesh mesh = icosphere(2);
  const auto write = [&](const char* name, float radius_m) {
    TriangleMesh ball = mesh;
    scale(ball, radius_m);
    write_mesh(scratch.path(name), ball);
    return scratch.path(name);
  };
  Scene scene = file_scene(write("outer.stl", 1.5e-3f));
  scene.tissues = {tissue("enamel"), tissue("dentine"), tissue("caries"), tissue("pulp")};
  scene.tissues[1].file = write("inner.stl", 1e-3f);
  scene.tissues[3].file = write("innermost.stl", 0.5e-3f);
  expect_hit_equals_miss(scene, cache);
  const VoxelModel model = build_workpiece(scene, &cache);
  EXPECT_EQ(model.tissue(Cell(20, 20, 20)), 3);
  EXPECT_EQ(model.tissue(Cell(27, 20, 20)), 1);
  EXPECT_EQ(model.tissue(Cell(32, 20, 20)), 0);
  expect_each_misses(
      scene, cache,
      {{"none", [](Scene& s) { s.tissues[3].file.clear(); }},
       {"of another tissue", [](Scene& s) { std::swap(s.tissues[2].file, s.tissues[3].file); }},
       {"another", [](Scene& s) { s.tissues[1].file = s.tissues[3].file; }}});
  write("inner.stl", 1.1e-3f);
  EXPECT_FALSE(is_hit(scene, cache));
}

TEST(BuildBodies, TheMeshesOfTissuesAreTheWorkpieces) {
  const ScratchFolder scratch;
  TriangleMesh mesh = icosphere(2);
  scale(mesh, 1e-3f);
  write_mesh(scratch.path("m.stl"), mesh);
  Scene scene = file_scene(scratch.path("m.stl"));
  scene.tissues = {tissue("enamel"), tissue("dentine")};
  scene.tissues[1].file = scratch.path("none.stl");
  BodySettings body;
  body.solid = scene.workpiece;
  scene.bodies.push_back(body);
  scene.bodies.push_back(body);
  scene.bodies.back().tissue = 1;
  for (const VoxelModel& model : build_bodies(scene)) {
    EXPECT_EQ(model.tissues, nullptr);
    EXPECT_GT(model.solid_count(), 3000u);
  }
  EXPECT_THROW(build_workpiece(scene), InputError);
}

/// A shape, a mesh, a mask and grey values.
std::vector<Scene> one_of_each(const ScratchFolder& scratch) {
  TriangleMesh mesh = icosphere(3);
  scale(mesh, 1.5e-3f);
  write_mesh(scratch.path("m.stl"), mesh);
  std::string grey;
  for (int v = 0; v < 32 * 32 * 32; ++v) {
    const Vector3d p(v % 32 - 15.5, v / 32 % 32 - 15.5, v / 1024 - 15.5);
    grey += static_cast<char>(std::clamp(100.0 * (11.0 - p.norm()), 0.0, 100.0));
  }
  const std::string volume =
      scratch.write("g.mha",
                    "ObjectType = Image\nNDims = 3\nDimSize = 32 32 32\nElementType = MET_UCHAR\n"
                    "ElementSpacing = 0.1 0.1 0.1\nElementDataFile = LOCAL\n" +
                        grey);
  std::vector<Scene> scenes = {shape_scene(), file_scene(scratch.path("m.stl")),
                               file_scene(ball_volume(scratch, "v.nrrd", 10.0)),
                               file_scene(volume)};
  scenes.back().workpiece.solid_above = 50.0;
  return scenes;
}

TEST(LoadCached, FractionsAreTheSameAndAreNotWhatIsBinary) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  for (Scene scene : one_of_each(scratch)) {
    build_workpiece(scene, &cache);
    scene.workpiece.surface = SurfaceKind::kFractions;
    EXPECT_FALSE(is_hit(scene, cache)) << scene.workpiece.file;
    expect_hit_equals_miss(scene, cache);
    const VoxelModel model = build_workpiece(scene, &cache);
    ASSERT_TRUE(model.fills);
    // Only a mask has nothing to tell.
    EXPECT_EQ(model.fills->pages().empty(), scene.workpiece.file.ends_with("v.nrrd"));
  }
}

TEST(BuildBodies, EachHasTheSurfaceThatItsTableSays) {
  const ScratchFolder scratch;
  for (const Scene& alone : one_of_each(scratch)) {
    Scene scene = shape_scene();
    BodySettings body;
    body.solid = alone.workpiece;
    scene.bodies.push_back(body);
    body.solid.surface = SurfaceKind::kFractions;
    scene.bodies.push_back(body);
    const std::vector<VoxelModel> models = build_bodies(scene);
    EXPECT_FALSE(models[0].fills) << alone.workpiece.file;
    EXPECT_TRUE(models[1].fills) << alone.workpiece.file;
    Scene filled = scene;
    filled.workpiece = body.solid;
    expect_equal(build_workpiece(filled), models[1]);
  }
}

TEST(BuildWorkpiece, AboveWithoutGreyValuesIsSaid) {
  Scene scene = shape_scene();
  ImportNotes notes;
  build_workpiece(scene, nullptr, &notes);
  EXPECT_TRUE(notes.warnings.empty());
  scene.tissues[1].above = 1500.0;
  build_workpiece(scene, nullptr, &notes);
  ASSERT_EQ(notes.warnings.size(), 1u);
  EXPECT_EQ(notes.warnings[0],
            "above of the tissue 'dentine' has no effect: the workpiece is no volume of grey "
            "values");
}

TEST(LoadCached, WhatIsWrongIsStillSaid) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  Scene scene = shape_scene();
  scene.workpiece.position_m.x() = 1.0;  // a metre beside the grid
  for (int run = 0; run < 2; ++run) EXPECT_THROW(build_workpiece(scene, &cache), InputError);
  EXPECT_THROW(build_workpiece(file_scene(scratch.path("none.nrrd")), &cache), InputError);
}

void expect_same_burr(const Burr& a, const Burr& b) {
  EXPECT_EQ(a.mesh_tool.triangles, b.mesh_tool.triangles);
  EXPECT_EQ(a.capsule.radius_m, b.capsule.radius_m);
  EXPECT_EQ(a.field.samples(), b.field.samples());
  EXPECT_EQ(a.field.grid().origin_tool, b.field.grid().origin_tool);
  ASSERT_EQ(a.field.values().size(), b.field.values().size());
  EXPECT_EQ(std::memcmp(a.field.values().data(), b.field.values().data(), a.field.memory_bytes()),
            0);
}

TEST(LoadCached, ABurrIsTheSame) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("c"));
  const Scene generated = shape_scene();
  Scene from_mesh = generated;
  write_mesh(scratch.path("b.stl"), [&] {
    TriangleMesh mesh = load_burr(generated).mesh_tool;
    for (Vector3f& p : mesh.positions) p = Vector3f(p.z(), p.x(), p.y());  // files: along z
    return mesh;
  }());
  from_mesh.burr.shape = BurrShape::kFile;
  from_mesh.burr.file = scratch.path("b.stl");
  int hits = 0;
  for (const Scene& scene : {generated, from_mesh}) {
    const Burr plain = load_burr(scene);
    expect_same_burr(plain, load_burr(scene, &cache));
    EXPECT_EQ(cache.hits(), hits);
    expect_same_burr(plain, load_burr(scene, &cache));
    EXPECT_EQ(cache.hits(), ++hits);
  }
  const std::vector<Change> changes = {
      {"shape", [](Scene& s) { s.burr.shape = BurrShape::kPear; }},
      {"diameter", [](Scene& s) { s.burr.diameter_m = 1.5e-3; }},
      {"samples", [](Scene& s) { s.burr.field_samples = Vector3i(18, 64, 18); }},
      {"spacing", [](Scene& s) { s.burr.field_spacing_m = 0.25e-3; }}};
  for (const auto& [what, change] : changes) {
    Scene other = generated;
    change(other);
    load_burr(other, &cache);
    EXPECT_EQ(cache.hits(), hits) << what;
  }
  Scene faster = generated;  // not in the field
  faster.burr.speed_rad_per_s *= 2.0;
  load_burr(faster, &cache);
  EXPECT_EQ(cache.hits(), ++hits);
}

}  // namespace
}  // namespace sulcus::load_cached_test
