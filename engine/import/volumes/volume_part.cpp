#include "engine/import/volumes/volume_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/input_geometry.hpp"

namespace sulcus {
namespace {

// Around what is taken, so that the surface there is as it is in the whole volume: more than the
// importer's stencils reach.
constexpr int kPartMargin = 6;

using Counts = std::map<float, std::uint64_t>;

bool has_labels(std::span<const TissueSettings> tissues) {
  return std::ranges::any_of(tissues, [](const TissueSettings& t) { return t.label.has_value(); });
}

Eigen::Affine3d file_from_lattice(const MedicalVolume& volume, const Eigen::Vector3d& spacing_m) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  result.linear() = volume.direction * spacing_m.asDiagonal();
  result.translation() = volume.origin_m;
  return result;
}

template <class Vector>
std::string text_of(const Vector& v, double unit) {
  std::ostringstream text;
  text.precision(7);
  for (int d = 0; d < v.size(); ++d) text << (d > 0 ? ", " : "") << v[d] / unit;
  return text.str();
}

/// Values in their order, the first of many.
std::string list_of(const Counts& counts) {
  constexpr std::size_t kMost = 20;
  std::ostringstream text;
  std::size_t n = 0;
  for (const auto& [value, count] : counts) {
    if (n++ == kMost) break;
    text << (n > 1 ? ", " : "") << value;
  }
  if (counts.size() > kMost) text << " and more";
  return text.str();
}

void check_lattice(const MedicalVolume& volume, const MedicalVolume& labels,
                   const WorkpieceSettings& settings) {
  if (labels.sizes != volume.sizes) {
    throw InputError(labels.file, "sizes", text_of(labels.sizes.cast<double>(), 1.0),
                     text_of(volume.sizes.cast<double>(), 1.0) + ", those of " + volume.file);
  }
  if (!volume.spacing_known || !labels.spacing_known || settings.spacing_m) return;
  constexpr double kSameWithin = 0.1;  // of a voxel
  const double tolerance_m = kSameWithin * volume.spacing_m.minCoeff();
  const auto refuse = [&](const char* place, const auto& found, const auto& expected, double unit) {
    throw InputError(labels.file, place, text_of(found, unit),
                     text_of(expected, unit) + ", that of " + volume.file);
  };
  const Eigen::Vector3d steps = (volume.sizes - Eigen::Vector3i::Ones()).cast<double>();
  const Eigen::Vector3d stretched = (labels.spacing_m - volume.spacing_m).cwiseProduct(steps);
  if (stretched.cwiseAbs().maxCoeff() > tolerance_m) {
    refuse("spacing", labels.spacing_m, volume.spacing_m, kMillimetre);
  }
  if ((labels.origin_m - volume.origin_m).cwiseAbs().maxCoeff() > tolerance_m) {
    refuse("origin", labels.origin_m, volume.origin_m, kMillimetre);
  }
  const Eigen::Matrix3d turned =
      (labels.direction - volume.direction) * volume.spacing_m.cwiseProduct(steps).asDiagonal();
  if (turned.cwiseAbs().maxCoeff() > tolerance_m) {
    refuse("direction", labels.direction.reshaped(), volume.direction.reshaped(), 1.0);
  }
}

/// Which of the labels' axes runs along each of the volume's, and in which sense: a matrix of 0, 1
/// and -1; none: no axis of the one is one of the other.
std::optional<Eigen::Matrix3i> turn_of(const MedicalVolume& labels, const MedicalVolume& volume) {
  const Eigen::Matrix3d turn = volume.direction.inverse() * labels.direction;
  const Eigen::Matrix3i whole = turn.array().round().cast<int>();
  const Eigen::Matrix3i sizes = whole.cwiseAbs();
  const bool one_each = sizes.rowwise().sum().isOnes() && sizes.colwise().sum().isOnes();
  return one_each ? std::optional(whole) : std::nullopt;
}

/// The same labels at the same places, their axes in the order and sense of the volume's.
MedicalVolume turned(const MedicalVolume& labels, const Eigen::Matrix3i& turn) {
  MedicalVolume result;
  result.file = labels.file;
  result.spacing_known = labels.spacing_known;
  result.sizes = turn.cwiseAbs() * labels.sizes;
  // p_labels = back * p_result + first.
  const Eigen::Matrix3i back = turn.transpose();
  const Eigen::Vector3i last = labels.sizes - Eigen::Vector3i::Ones();
  const Eigen::Vector3i first =
      (back.rowwise().sum().array() < 0).select(last, Eigen::Vector3i::Zero());
  result.spacing_m = turn.cast<double>().cwiseAbs() * labels.spacing_m;
  result.direction = labels.direction * back.cast<double>();
  result.origin_m =
      labels.origin_m + labels.direction * labels.spacing_m.cwiseProduct(first.cast<double>());
  result.values.reserve(labels.values.size());
  for_each_cell(Cell::Zero(), result.sizes, [&](const Cell& voxel) {
    const Eigen::Vector3i p = back * voxel + first;
    result.values.push_back(labels.at(p.x(), p.y(), p.z()));
  });
  return result;
}

/// Indices [low, high) that a box reaches, within the lattice; by its corners along the file's
/// axes, so that of an oblique lattice it is more than the box.
struct IndexBox {
  Eigen::Vector3i low, high;
};

IndexBox reach_of(const Eigen::AlignedBox3d& box_file, const Eigen::Affine3d& lattice_from_file,
                  const Eigen::Vector3i& sizes) {
  Eigen::AlignedBox3d box;
  for (int c = 0; c < 8; ++c) {
    box.extend(lattice_from_file *
               box_file.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)));
  }
  const Eigen::Vector3d last = sizes.cast<double>();
  const Eigen::Vector3d low = (box.min().array() - 1.0).max(0.0).min(last.array()).floor();
  const Eigen::Vector3d high = (box.max().array() + 2.0).max(0.0).min(last.array()).floor();
  return {low.cast<int>(), high.cast<int>()};
}

[[noreturn]] void throw_empty_box(const MedicalVolume& volume, const Eigen::Affine3d& lattice,
                                  const Eigen::AlignedBox3d& box_file) {
  Eigen::AlignedBox3d bounds;
  const Eigen::Vector3d last = (volume.sizes - Eigen::Vector3i::Ones()).cast<double>();
  for (int c = 0; c < 8; ++c) {
    bounds.extend(lattice * Eigen::Vector3d((c & 1) * last.x(), (c >> 1 & 1) * last.y(),
                                            (c >> 2) * last.z()));
  }
  const auto corners = [](const Eigen::AlignedBox3d& box) {
    return "[" + text_of(box.min(), kMillimetre) + ", " + text_of(box.max(), kMillimetre) + "]";
  };
  throw InputError(volume.file, "box_mm", corners(box_file) + ", without a voxel of it",
                   "a box within " + corners(bounds));
}

/// The mean of what is not solid: what takes the place of other solids.
float air_of(const MedicalVolume& volume, float level) {
  double sum = 0.0;
  std::uint64_t count = 0;
  for (const float v : volume.values) {
    if (v < level) sum += v, ++count;
  }
  return count > 0 ? static_cast<float>(sum / static_cast<double>(count)) : level - 1.0f;
}

/// Which voxels are taken, and what there was beside them.
class Choice {
 public:
  Choice(const MedicalVolume& volume, const MedicalVolume* labels,
         const WorkpieceSettings& settings, std::span<const TissueSettings> tissues,
         const Eigen::Affine3d& lattice)
      : volume_(volume),
        labelled_(settings.label ? labels ? labels : &volume : nullptr),
        box_(settings.box_file),
        label_(static_cast<float>(settings.label.value_or(0))),
        map_(!settings.solid_above && has_labels(tissues)),
        lattice_(lattice) {
    for (const TissueSettings& t : tissues) {
      if (t.label) known_.push_back(static_cast<float>(*t.label));
    }
  }

  bool taken(int i, int j, int k) {
    if (box_ && !box_->contains(lattice_ * Eigen::Vector3d(i, j, k))) return false;
    ++in_box;
    const std::size_t v = volume_.index(i, j, k);
    if (labelled_) {
      if (const float value = labelled_->values[v]; value != label_) {
        if (value != 0.0f) count(other_labels, value);
        return false;
      }
    }
    const float value = volume_.values[v];
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    if (!map_) return true;
    if (std::ranges::find(known_, value) != known_.end()) return true;
    if (value != 0.0f) count(without_tissue, value);
    return false;
  }

  const MedicalVolume* labelled() const { return labelled_; }

  std::uint64_t in_box = 0;
  // Of the file, where the box and the label are.
  float least = std::numeric_limits<float>::infinity(), greatest = -least;
  Counts other_labels, without_tissue;  // values but 0, of voxels in the box

 private:
  /// A volume that is no label map has any number of values.
  static void count(Counts& counts, float value) {
    constexpr std::size_t kMostValues = 1000;
    if (const auto found = counts.find(value); found != counts.end()) {
      ++found->second;
    } else if (counts.size() < kMostValues) {
      counts.emplace(value, 1);
    }
  }

  const MedicalVolume& volume_;
  const MedicalVolume* labelled_;
  std::optional<Eigen::AlignedBox3d> box_;
  float label_;
  bool map_;
  Eigen::Affine3d lattice_;
  std::vector<float> known_;
};

[[noreturn]] void throw_nothing(const MedicalVolume& volume, const WorkpieceSettings& settings,
                                const Choice& choice) {
  const std::string where = settings.box_file ? " in box_mm" : "";
  if (choice.labelled() && choice.without_tissue.empty()) {
    throw InputError(
        choice.labelled()->file, "label",
        "no voxel" + where + " of value " + std::to_string(*settings.label),
        choice.other_labels.empty() ? "one" : "one of " + list_of(choice.other_labels));
  }
  throw InputError(volume.file, "label", "no voxel" + where + " whose value a [[tissue]] has",
                   choice.without_tissue.empty() ? "a label map that is not empty"
                                                 : "label = " + list_of(choice.without_tissue));
}

/// The voxels of `volume` from `low` to before `high`.
MedicalVolume cropped(const MedicalVolume& volume, const Eigen::Vector3i& low,
                      const Eigen::Vector3i& high, const Eigen::Affine3d& lattice) {
  MedicalVolume part;
  part.file = volume.file;
  part.sizes = high - low;
  part.spacing_m = volume.spacing_m;
  part.spacing_known = volume.spacing_known;
  part.direction = volume.direction;
  part.origin_m = lattice * low.cast<double>();
  part.values.reserve(static_cast<std::size_t>(part.sizes.cast<std::ptrdiff_t>().prod()));
  for (int k = low.z(); k < high.z(); ++k) {
    for (int j = low.y(); j < high.y(); ++j) {
      const float* row = &volume.values[volume.index(low.x(), j, k)];
      part.values.insert(part.values.end(), row, row + part.sizes.x());
    }
  }
  return part;
}

}  // namespace

bool names_a_part(const WorkpieceSettings& settings, std::span<const TissueSettings> tissues) {
  return settings.box_file || settings.label || (!settings.solid_above && has_labels(tissues));
}

MedicalVolume take_part(MedicalVolume volume, const MedicalVolume* labels,
                        const WorkpieceSettings& settings, std::span<const TissueSettings> tissues,
                        std::vector<std::string>& warnings) {
  if (!names_a_part(settings, tissues)) return volume;
  std::optional<MedicalVolume> in_order;
  if (labels) {
    const std::optional<Eigen::Matrix3i> turn = turn_of(*labels, volume);
    if (turn && !turn->isIdentity()) labels = &in_order.emplace(turned(*labels, *turn));
    check_lattice(volume, *labels, settings);
  }
  const Eigen::Affine3d lattice =
      file_from_lattice(volume, settings.spacing_m.value_or(volume.spacing_m));
  IndexBox reach{Eigen::Vector3i::Zero(), volume.sizes};
  if (settings.box_file) reach = reach_of(*settings.box_file, lattice.inverse(), volume.sizes);

  Choice choice(volume, labels, settings, tissues, lattice);
  // As many bits as voxels of the reach, and the box of those that are set.
  const Eigen::Vector3i size = (reach.high - reach.low).cwiseMax(0);
  std::vector<bool> taken(static_cast<std::size_t>(size.cast<std::ptrdiff_t>().prod()));
  Eigen::Vector3i low = volume.sizes, high = Eigen::Vector3i::Zero();
  std::size_t bit = 0;
  for_each_cell(reach.low, reach.high, [&](const Cell& voxel) {
    if (choice.taken(voxel.x(), voxel.y(), voxel.z())) {
      taken[bit] = true;
      low = low.cwiseMin(voxel);
      high = high.cwiseMax(voxel + Cell::Ones());
    }
    ++bit;
  });
  if (settings.box_file && choice.in_box == 0) {
    throw_empty_box(volume, lattice, *settings.box_file);
  }
  if ((low.array() >= high.array()).any()) throw_nothing(volume, settings, choice);
  if (settings.solid_above && choice.greatest < static_cast<float>(*settings.solid_above)) {
    std::ostringstream found, expected;
    found << "grey values from " << choice.least << " to " << choice.greatest
          << (settings.box_file ? " in box_mm" : "") << (settings.label ? " at that label" : "");
    expected << "some at or above " << *settings.solid_above;
    throw InputError(volume.file, "solid_above", found.str(), expected.str());
  }
  if (!choice.without_tissue.empty()) {
    warnings.push_back("the file has values without a [[tissue]], which are left out: " +
                       list_of(choice.without_tissue));
  }

  const Eigen::Vector3i first = (low - Eigen::Vector3i::Constant(kPartMargin)).cwiseMax(0);
  const Eigen::Vector3i end =
      (high + Eigen::Vector3i::Constant(kPartMargin)).cwiseMin(volume.sizes);
  MedicalVolume part = cropped(volume, first, end, lattice);
  const bool mask = !settings.solid_above;
  const float level = mask ? 0.0f : static_cast<float>(*settings.solid_above);
  const float air = mask ? 0.0f : air_of(volume, level);
  auto value = part.values.begin();
  for_each_cell(first, end, [&](const Cell& voxel) {
    const Eigen::Vector3i at = voxel - reach.low;
    const bool reached = (at.array() >= 0).all() && (at.array() < size.array()).all();
    const std::size_t place =
        static_cast<std::size_t>(at.x()) +
        static_cast<std::size_t>(size.x()) *
            (static_cast<std::size_t>(at.y()) +
             static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(at.z()));
    const bool stays = reached && taken[place];
    if (!stays && (mask || *value >= level)) *value = air;
    ++value;
  });
  return part;
}

}  // namespace sulcus
