#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "engine/core/huge_pages.hpp"
#include "engine/tool/burr_profile.hpp"
#include "engine/tool/field_grid.hpp"

namespace sulcus {

/// Whether a field is its own mirror image in the middle planes across x and z, as that of what
/// turns about the middle of its box is. Then one quarter is kept.
enum class FieldMirrors : std::uint8_t { kNone, kXAndZ };

/// Signed distances to a burr, sampled on a grid in tool space: float metres, negative inside,
/// trilinear in between [Kim and Park 2019, III-A]. Memory is taken when it is built; sampling
/// allocates nothing, throws nothing and uses no function but sqrt, in one fixed order of single
/// operations, so that every x86-64 machine gives the same bits, with mirrors and without. Any
/// number of threads may sample.
class DistanceField {
 public:
  DistanceField() = default;
  /// All samples zero.
  explicit DistanceField(const FieldGrid& grid, FieldMirrors mirrors = FieldMirrors::kNone)
      : grid_(grid), kept_(grid.samples) {
    if (mirrors == FieldMirrors::kXAndZ) {
      // To the middle and, of an even number, one more: the cell there is kept as any other.
      kept_.x() = kept_.x() / 2 + 1;
      kept_.z() = kept_.z() / 2 + 1;
    }
    row_pitch_ = odd_lines(kept_.x());
    slice_pitch_ = odd_lines(row_pitch_ * kept_.y());
    values_.resize(static_cast<std::size_t>(slice_pitch_ * kept_.z()));
  }

  const FieldGrid& grid() const { return grid_; }
  const Eigen::Vector3i& samples() const { return grid_.samples; }
  double spacing_m() const { return grid_.spacing_m; }
  Eigen::Vector3d field_from_tool(const Eigen::Vector3d& p_tool) const {
    return grid_.field_from_tool(p_tool);
  }

  /// Samples along each axis that are kept; cell i of the others is the mirror image of cell
  /// samples() - 2 - i.
  const Eigen::Vector3i& kept() const { return kept_; }
  /// x fastest; a kept sample (i, j, k) is at i + j row_pitch() + k slice_pitch(), padding is zero.
  std::span<const float> values() const { return values_; }
  std::span<float> values() { return values_; }
  std::ptrdiff_t row_pitch() const { return row_pitch_; }
  std::ptrdiff_t slice_pitch() const { return slice_pitch_; }
  std::size_t memory_bytes() const { return values_.size() * sizeof(float); }

  float at(int i, int j, int k) const {
    const auto kept = [&](int axis, int of) {
      return of < kept_[axis] ? of : grid_.samples[axis] - 1 - of;
    };
    return values_[offset(kept(0, i), j, kept(2, k))];
  }
  /// Of one that is kept.
  float& kept_at(int i, int j, int k) { return values_[offset(i, j, k)]; }

  /// Distance at a point of field space, m. Outside the box: the value at the nearest point of the
  /// box plus the distance from there, so continuous and positive. Not finite in, not finite out.
  float sample(const Eigen::Vector3f& p_field) const noexcept {
    const Cell cell = locate(p_field);
    const float* v = cell.corner;
    const std::ptrdiff_t x = cell.to_x, r = row_pitch_;
    const float y0 =
        lerp(lerp(v[0], v[x], cell.t.x()), lerp(v[r], v[r + x], cell.t.x()), cell.t.y());
    v += cell.to_z;
    const float y1 =
        lerp(lerp(v[0], v[x], cell.t.x()), lerp(v[r], v[r + x], cell.t.x()), cell.t.y());
    return lerp(y0, y1, cell.t.z()) + outside_m(cell);
  }

  /// The same bits, and the gradient of that very function in tool space, m per m (about unit
  /// length near the surface). On cell faces, where it jumps, it is that of the upper cell.
  float sample_with_gradient(const Eigen::Vector3f& p_field,
                             Eigen::Vector3f& gradient) const noexcept {
    const Cell cell = locate(p_field);
    const Eigen::Vector3f& t = cell.t;
    const float* v = cell.corner;
    const float* w = v + cell.to_z;
    const std::ptrdiff_t x = cell.to_x, r = row_pitch_;
    const float x00 = lerp(v[0], v[x], t.x()), x10 = lerp(v[r], v[r + x], t.x());
    const float x01 = lerp(w[0], w[x], t.x()), x11 = lerp(w[r], w[r + x], t.x());
    const float y0 = lerp(x00, x10, t.y()), y1 = lerp(x01, x11, t.y());
    const float dx = lerp(lerp(v[x] - v[0], v[r + x] - v[r], t.y()),
                          lerp(w[x] - w[0], w[r + x] - w[r], t.y()), t.z());
    const float dy = lerp(x10 - x00, x11 - x01, t.z());
    const float dz = y1 - y0;
    const float per_m = 1.0f / static_cast<float>(grid_.spacing_m);
    gradient = Eigen::Vector3f(dx * per_m, dy * per_m, dz * per_m);

    const float beyond = outside_m(cell);
    if (!(beyond == 0.0f)) {
      // Beyond a face the box's value no longer changes along its normal; the way there does.
      const float length = beyond * per_m;
      for (int a = 0; a < 3; ++a) {
        if (!(cell.beyond[a] == 0.0f)) gradient[a] = cell.beyond[a] / length;
      }
    }
    return lerp(y0, y1, t.z()) + beyond;
  }

 private:
  struct Cell {
    const float* corner;        // sample at the low corner
    std::ptrdiff_t to_x, to_z;  // from a sample to the next one: backward in a mirror image
    Eigen::Vector3f t;          // place in the cell, 0 to 1
    Eigen::Vector3f beyond;     // from the nearest point of the box to the point, samples
  };
  /// A cell of an axis with mirrors: its lower sample among those that are kept, and the way to
  /// its upper one.
  struct Along {
    int low, step;
  };
  Along along(int axis, int i) const {
    return i + 1 < kept_[axis] ? Along{i, 1} : Along{grid_.samples[axis] - 1 - i, -1};
  }

  /// Rows and slices take an odd number of cache lines: neighbours in y and z then fall into
  /// different cache sets even where the samples are powers of two.
  static std::ptrdiff_t odd_lines(std::ptrdiff_t floats) {
    constexpr std::ptrdiff_t kLine = 64 / sizeof(float);
    return (((floats + kLine - 1) / kLine) | 1) * kLine;
  }
  std::size_t offset(int i, int j, int k) const {
    return static_cast<std::size_t>(i + j * row_pitch_ + k * slice_pitch_);
  }
  static float lerp(float a, float b, float t) { return a + t * (b - a); }

  float outside_m(const Cell& cell) const noexcept {
    const Eigen::Vector3f& b = cell.beyond;
    const float squared = b.x() * b.x() + b.y() * b.y() + b.z() * b.z();
    if (squared == 0.0f) return 0.0f;
    return std::sqrt(squared) * static_cast<float>(grid_.spacing_m);
  }

  Cell locate(const Eigen::Vector3f& p) const noexcept {
    Cell cell;
    int index[3];
    for (int a = 0; a < 3; ++a) {
      const auto last = static_cast<float>(grid_.samples[a] - 1);
      // Written so that NaN becomes 0: the memory read stays in the box, `beyond` carries the NaN.
      const float low = p[a] > 0.0f ? p[a] : 0.0f;
      const float inside = low < last ? low : last;
      cell.beyond[a] = p[a] - inside;
      const int i = std::min(static_cast<int>(inside), grid_.samples[a] - 2);
      cell.t[a] = inside - static_cast<float>(i);
      index[a] = i;
    }
    const Along x = along(0, index[0]), z = along(2, index[2]);
    cell.corner = values_.data() + offset(x.low, index[1], z.low);
    cell.to_x = x.step;
    cell.to_z = z.step * slice_pitch_;
    return cell;
  }

  FieldGrid grid_;
  Eigen::Vector3i kept_ = Eigen::Vector3i::Zero();
  std::ptrdiff_t row_pitch_ = 0;
  std::ptrdiff_t slice_pitch_ = 0;
  HugePageVector<float> values_;
};

/// The field of a generated burr, with its mirrors: at each sample the exact distance to its
/// profile. The grid must be centred on the tool's axis, as plan_field makes it. The result does
/// not depend on threads.
DistanceField field_from_profile(const BurrProfile& profile, const FieldGrid& grid);

}  // namespace sulcus
