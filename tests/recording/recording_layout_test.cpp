#include "engine/recording/recording_layout.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <hdf5.h>

#include "tests/recording/sample_recording.hpp"
#include "tests/support/filled_model.hpp"

// The layout against recordings as they were written, read by HDF5 alone.

namespace sulcus::sample::recording_layout_test {
namespace {

/// "f64[3]", as HDF5 has it; the type is closed.
std::string name_of(hid_t type, hsize_t columns = 1) {
  std::string name = "?";
  if (H5Tget_class(type) == H5T_STRING) name = "text";
  if (H5Tget_class(type) == H5T_ARRAY) {
    hsize_t length = 0;
    EXPECT_EQ(H5Tget_array_ndims(type), 1);
    H5Tget_array_dims2(type, &length);
    name = name_of(H5Tget_super(type), length);
  }
  const std::string bits = std::to_string(8 * H5Tget_size(type));
  if (H5Tget_class(type) == H5T_FLOAT) name = "f" + bits;
  if (H5Tget_class(type) == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE) name = "u" + bits;
  H5Tclose(type);
  return columns > 1 ? name + "[" + std::to_string(columns) + "]" : name;
}

std::string name_of(const StoredField& field) {
  static const std::map<StoredType, std::string> kNames{
      {StoredType::kU8, "u8"},    {StoredType::kU16, "u16"}, {StoredType::kU32, "u32"},
      {StoredType::kU64, "u64"},  {StoredType::kF32, "f32"}, {StoredType::kF64, "f64"},
      {StoredType::kText, "text"}};
  const std::string name = kNames.at(field.type);
  return field.count > 1 ? name + "[" + std::to_string(field.count) + "]" : name;
}

/// Columns or attributes, "name type", and how the object is shaped.
struct Found {
  StoredKind kind = StoredKind::kGroup;
  std::vector<std::string> fields;
};

std::vector<std::string> attributes_of(hid_t object) {
  std::vector<std::string> fields;
  H5Aiterate2(
      object, H5_INDEX_NAME, H5_ITER_INC, nullptr,
      [](hid_t owner, const char* name, const H5A_info_t*, void* all) -> herr_t {
        const hid_t attribute = H5Aopen(owner, name, H5P_DEFAULT);
        const hid_t space = H5Aget_space(attribute);
        const hssize_t count = H5Sget_simple_extent_npoints(space);
        static_cast<std::vector<std::string>*>(all)->push_back(
            std::string(name) + " " + name_of(H5Aget_type(attribute), count));
        H5Sclose(space);
        H5Aclose(attribute);
        return 0;
      },
      &fields);
  return fields;
}

Found data_set(hid_t object) {
  Found found;
  const hid_t type = H5Dget_type(object), space = H5Dget_space(object);
  const int dimensions = H5Sget_simple_extent_ndims(space);
  hsize_t sizes[2]{};
  EXPECT_LE(dimensions, 2);
  H5Sget_simple_extent_dims(space, sizes, nullptr);
  if (H5Tget_class(type) == H5T_COMPOUND) {
    found.kind = dimensions == 0 ? StoredKind::kRow : StoredKind::kRows;
    for (unsigned m = 0; m < static_cast<unsigned>(H5Tget_nmembers(type)); ++m) {
      char* name = H5Tget_member_name(type, m);
      found.fields.push_back(std::string(name) + " " + name_of(H5Tget_member_type(type, m)));
      H5free_memory(name);
    }
  } else {
    found.kind = StoredKind::kArray;
    found.fields.push_back(" " + name_of(H5Tcopy(type), dimensions == 2 ? sizes[1] : 1));
  }
  H5Sclose(space);
  H5Tclose(type);
  return found;
}

/// Every object of a file, by its path.
std::map<std::string, Found> objects_of(const std::string& path) {
  std::map<std::string, Found> objects;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(file, 0);
  H5Ovisit(
      file, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t root, const char* name, const H5O_info_t* info, void* all) -> herr_t {
        const hid_t object = H5Oopen(root, name, H5P_DEFAULT);
        Found found;
        if (info->type == H5O_TYPE_DATASET) {
          found = data_set(object);
          EXPECT_TRUE(attributes_of(object).empty()) << name;
        } else {
          found.fields = attributes_of(object);
        }
        H5Oclose(object);
        const std::string place(name);
        (*static_cast<std::map<std::string, Found>*>(all))[place == "." ? "/" : "/" + place] =
            found;
        return 0;
      },
      &objects);
  H5Fclose(file);
  return objects;
}

/// What the layout says of an object; of those that are like another, that one's.
Found told(std::string path) {
  path = std::regex_replace(path, std::regex("^/bodies/[0-9]+"), "/bodies/0");
  for (const StoredPart& part : recording_layout()) {
    const std::string one(part.path);
    if (!part.like.empty() && (path == one || path.starts_with(one + "/"))) {
      path.replace(0, one.size(), part.like);
    }
  }
  const StoredPart* part = find_stored_part(path);
  if (part == nullptr) {
    ADD_FAILURE() << path << " is not in the layout";
    return {};
  }
  Found found{part->kind, {}};
  for (const StoredField& field : part->fields) {
    found.fields.push_back(std::string(field.name) + " " + name_of(field));
  }
  return found;
}

class RecordingLayoutTest : public RecordingTest {
 protected:
  /// With all that a recording may have.
  std::string write_everything() const {
    const TriangleMesh mesh = burr();
    RecordingHeader all = header();
    all.parent = "earlier.h5 at 3 s";
    all.repaired = "/end";
    VoxelModel goal;
    goal.grid = workpiece().grid;
    goal.leaves.resize(goal.grid.leaf_count());
    goal.set({9, 10, 11}, true);
    const InputGeometry input;
    const VoxelModel filled = test::filled_anyhow(workpiece(), 1);
    const EarlierRun earlier{"earlier.h5", "of its scene", filled, {}, {}};
    RecordingWriter writer(path(), all, filled, &mesh,
                           {.cutting = true, .port = true, .pieces = true, .pedal = true},
                           {{&filled, &filled}, &goal, &input, &earlier});
    writer.close();
    return path();
  }
};

void expect_as_told(const std::map<std::string, Found>& objects) {
  for (const auto& [path, found] : objects) {
    SCOPED_TRACE(path);
    Found expected = told(path);
    EXPECT_EQ(found.kind, expected.kind);
    std::vector<std::string> fields = found.fields;
    if (found.kind == StoredKind::kGroup) {  // attributes have no order
      std::ranges::sort(fields);
      std::ranges::sort(expected.fields);
    }
    EXPECT_EQ(fields, expected.fields);
  }
}

TEST_F(RecordingLayoutTest, IsThatOfARecordingWithEverything) {
  std::map<std::string, Found> objects = objects_of(write_everything());
  // Of the goal's one tissue no labels are kept, nor of what is like the workpiece more than it
  // has.
  expect_as_told(objects);
  for (const StoredPart& part : recording_layout()) {
    EXPECT_TRUE(objects.contains(std::string(part.path))) << part.path;
  }
  EXPECT_EQ(objects.count("/bodies/1/mixed_labels"), 1u);
}

TEST_F(RecordingLayoutTest, WhatItSaysIsNotInAllIsNotInTheLeast) {
  VoxelModel plain = workpiece();
  plain.tissues = nullptr;
  RecordingWriter(path(), header(), plain, nullptr).close();
  std::map<std::string, Found> objects = objects_of(path());
  for (const StoredPart& part : recording_layout()) {
    const bool of_burr = part.path.starts_with("/burr");
    EXPECT_EQ(objects.contains(std::string(part.path)), part.when.empty() && !of_burr) << part.path;
  }
  // Of the attributes of the file two are told to be there only sometimes.
  Found& root = objects.at("/");
  root.fields.insert(root.fields.end(), {"parent text", "repaired text"});
  expect_as_told(objects);
}

TEST_F(RecordingLayoutTest, UnitsAreThoseOfTheNames) {
  const std::map<std::string, std::string> units{{"_m", "m"},         {"_s", "s"},    {"_us", "us"},
                                                 {"_N", "N"},         {"_Nm", "N m"}, {"_J", "J"},
                                                 {"_per_s", "rad/s"}, {"_hz", "Hz"}};
  int with_unit = 0;
  for (const StoredPart& part : recording_layout()) {
    for (const StoredField& field : part.fields) {
      if (field.name.empty()) continue;
      std::string expected, longest;
      for (const auto& [ending, unit] : units) {
        if (field.name.ends_with(ending) && ending.size() > longest.size()) {
          longest = ending;
          expected = unit;
        }
      }
      EXPECT_EQ(field.unit, expected) << part.path << " " << field.name;
      with_unit += expected.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(with_unit, 15);
}

}  // namespace
}  // namespace sulcus::sample::recording_layout_test
