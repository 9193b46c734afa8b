#include "tools/sulcus_lab/truth/truth_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus::lab {

namespace {

constexpr std::string_view kHeader = "i,j,k,nx,ny,nz,zone";
constexpr std::size_t kFields = 7;
constexpr double kLengthTolerance = 0.01;

/// One line of a table, for messages.
struct Line {
  const std::string& file;
  std::size_t number;
  std::string_view text;

  [[noreturn]] void refuse(std::string_view found, std::string_view expected) const {
    throw InputError(file, "line " + std::to_string(number), found, expected);
  }
};

std::string in_quotes(std::string_view text) {
  return std::string("'").append(text.substr(0, 80)).append("'");
}

std::array<std::string_view, kFields> split(const Line& line) {
  std::array<std::string_view, kFields> fields;
  std::string_view rest = line.text;
  for (std::size_t f = 0; f < kFields; ++f) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string_view::npos) != (f + 1 == kFields)) {
      line.refuse(in_quotes(line.text), "seven fields, " + std::string(kHeader));
    }
    fields[f] = rest.substr(0, comma);
    rest.remove_prefix(f + 1 == kFields ? rest.size() : comma + 1);
  }
  return fields;
}

template <class Number>
Number number_of(const Line& line, std::string_view text, std::string_view expected) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    line.refuse(in_quotes(text), expected);
  return value;
}

/// Place of a zone in the list, which it is added to if it is new.
int zone_of(const Line& line, std::string_view word, std::vector<std::string>& zones) {
  const bool is_word = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  });
  if (!is_word) line.refuse(in_quotes(word), "a zone of letters, digits, '_', '-' or '.'");
  if (word == "all") line.refuse("the zone 'all'", "another word: 'all' is every voxel");
  const auto at = std::find(zones.begin(), zones.end(), word);
  if (at != zones.end()) return static_cast<int>(at - zones.begin());
  zones.emplace_back(word);
  return static_cast<int>(zones.size()) - 1;
}

TruthVoxel parse(const Line& line, const Workpiece& workpiece, std::vector<std::string>& zones) {
  const auto fields = split(line);
  TruthVoxel voxel;
  for (int axis = 0; axis < 3; ++axis) {
    voxel.cell[axis] = number_of<int>(line, fields[axis], "a whole number, the voxel's index");
    voxel.normal[axis] = number_of<double>(line, fields[3 + axis], "a number, of a unit normal");
  }
  if (!workpiece.is_surface(voxel.cell)) {
    const std::string at = "voxel (" + std::to_string(voxel.cell.x()) + ", " +
                           std::to_string(voxel.cell.y()) + ", " + std::to_string(voxel.cell.z()) +
                           ")";
    line.refuse(at + (!workpiece.grid().contains(voxel.cell) ? " outside the volume"
                      : workpiece.solid(voxel.cell)          ? " inside the solid"
                                                             : ", which is empty"),
                "a solid voxel with an empty neighbour");
  }
  const double length = voxel.normal.norm();
  if (!(std::abs(length - 1.0) <= kLengthTolerance)) {
    line.refuse("a normal of length " + std::to_string(length), "length 1 (1 % off at most)");
  }
  voxel.normal /= length;
  voxel.zone = zone_of(line, fields[6], zones);
  return voxel;
}

}  // namespace

VoxelModel model_of_mask(const MedicalVolume& volume) {
  VoxelModel model;
  for (int axis = 0; axis < 3; ++axis) {
    if (volume.sizes[axis] > kMaxCellsPerAxis) {
      throw InputError(volume.file, "sizes", std::to_string(volume.sizes[axis]) + " voxels",
                       "at most " + std::to_string(kMaxCellsPerAxis) + " along an axis");
    }
  }
  model.grid.cells = (volume.sizes.array() + (kLeafEdge - 1)) / kLeafEdge * kLeafEdge;
  model.grid.voxel_m = volume.spacing_m.x();
  model.leaves.resize(model.grid.leaf_count());
  for (int k = 0; k < volume.sizes.z(); ++k) {
    for (int j = 0; j < volume.sizes.y(); ++j) {
      for (int i = 0; i < volume.sizes.x(); ++i) {
        if (volume.at(i, j, k) > 0.0f) model.set({i, j, k}, true);
      }
    }
  }
  return model;
}

VoxelModel model_of_fills(const MedicalVolume& levels, const VoxelModel& mask) {
  VoxelModel model;
  model.grid = mask.grid;
  model.leaves.resize(model.grid.leaf_count());
  const Eigen::Vector3i padded = (levels.sizes.array() + (kLeafEdge - 1)) / kLeafEdge * kLeafEdge;
  if (padded != model.grid.cells) {
    std::ostringstream found, expected;
    found << levels.sizes.transpose() << " voxels";
    expected << "the size of --volume, up to " << model.grid.cells.transpose();
    throw InputError(levels.file, "sizes", found.str(), expected.str());
  }
  model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
  model.fills->reserve(model.grid.leaf_count());
  for (int k = 0; k < levels.sizes.z(); ++k) {
    for (int j = 0; j < levels.sizes.y(); ++j) {
      for (int i = 0; i < levels.sizes.x(); ++i) {
        const float value = levels.at(i, j, k);
        const auto refuse = [&](const std::string& expected) {
          std::ostringstream place, found;
          place << "voxel (" << i << ", " << j << ", " << k << ")";
          found << value;
          throw InputError(levels.file, place.str(), found.str(), expected);
        };
        if (!(value >= 0.0f && value <= kFullLevel) || value != std::floor(value)) {
          refuse("a level, 0 to 255");
        }
        if (value == 0.0f && mask.solid({i, j, k})) refuse("1 to 255: --volume has it solid");
        if (value > 0.0f) model.set_level({i, j, k}, static_cast<FillLevel>(value));
      }
    }
  }
  return model;
}

TruthShape read_truth_file(const std::string& file, VoxelModel model, std::string name) {
  std::ifstream in(file);
  if (!in) throw InputError(file, "", "no readable file", "a table of normals");
  TruthShape truth;
  truth.name = std::move(name);
  const Workpiece workpiece{VoxelModel(model)};
  truth.model = std::move(model);

  std::string text;
  const auto next_line = [&] {
    if (!std::getline(in, text)) return false;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return true;
  };
  if (!next_line() || text != kHeader) {
    throw InputError(file, "line 1", in_quotes(text), kHeader);
  }
  std::unordered_set<std::uint32_t> seen;
  for (std::size_t number = 2; next_line(); ++number) {
    if (text.empty()) continue;
    const Line line{file, number, text};
    const TruthVoxel voxel = parse(line, workpiece, truth.zones);
    if (!seen.insert(voxel_key(voxel.cell)).second) {
      line.refuse("a voxel that was listed before", "each voxel once");
    }
    truth.voxels.push_back(voxel);
  }
  if (truth.voxels.empty()) throw InputError(file, "", "no normals", "at least one row");
  return truth;
}

}  // namespace sulcus::lab
