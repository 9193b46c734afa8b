#include "app/playback/tool_path.hpp"

#include <array>
#include <cstdio>
#include <string_view>
#include <vector>

#include "engine/core/file_kind.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

struct PathPoint {
  Eigen::Vector3d p_mm;
  double time_s, force_N;
  unsigned removed;
};

template <class... Values>
void append(std::string& text, const char* format, Values... values) {
  std::array<char, 160> line{};
  const int length = std::snprintf(line.data(), line.size(), format, values...);
  text.append(line.data(), static_cast<std::size_t>(length));
}

std::string vtk_of(std::span<const PathPoint> points) {
  const std::size_t n = points.size();
  std::string text = "# vtk DataFile Version 3.0\nWay of the burr, mm\nASCII\nDATASET POLYDATA\n";
  append(text, "POINTS %zu double\n", n);
  for (const PathPoint& at : points) {
    append(text, "%.9g %.9g %.9g\n", at.p_mm.x(), at.p_mm.y(), at.p_mm.z());
  }
  append(text, "LINES 1 %zu\n%zu", n + 1, n);
  for (std::size_t i = 0; i < n; ++i) append(text, i % 16 == 0 ? "\n%zu" : " %zu", i);
  append(text, "\nPOINT_DATA %zu\nFIELD values 3\ntime_s 1 %zu double\n", n, n);
  for (const PathPoint& at : points) append(text, "%.9g\n", at.time_s);
  append(text, "force_N 1 %zu double\n", n);
  for (const PathPoint& at : points) append(text, "%.9g\n", at.force_N);
  append(text, "removed 1 %zu unsigned_int\n", n);
  for (const PathPoint& at : points) append(text, "%u\n", at.removed);
  return text;
}

std::string ply_of(std::span<const PathPoint> points) {
  std::string text = "ply\nformat ascii 1.0\ncomment way of the burr, mm\n";
  append(text, "element vertex %zu\n", points.size());
  for (const char* name : {"x", "y", "z", "time_s", "force_N"}) {
    append(text, "property double %s\n", name);
  }
  text += "property uint removed\n";
  append(text, "element edge %zu\n", points.size() - 1);
  text += "property int vertex1\nproperty int vertex2\nend_header\n";
  for (const PathPoint& at : points) {
    append(text, "%.9g %.9g %.9g %.9g %.9g %u\n", at.p_mm.x(), at.p_mm.y(), at.p_mm.z(), at.time_s,
           at.force_N, at.removed);
  }
  for (std::size_t i = 1; i < points.size(); ++i) append(text, "%zu %zu\n", i - 1, i);
  return text;
}

}  // namespace

void write_tool_path(const std::string& file, std::span<const TickRecord> rows,
                     const Eigen::Affine3d& space_from_world) {
  std::vector<PathPoint> points;
  points.reserve(rows.size());
  for (const TickRecord& row : rows) {
    const Eigen::Vector3d p_world(row.tool_position_m);
    points.push_back({space_from_world * p_world / kMillimetre, row.time_s,
                      Eigen::Vector3d(row.force_N).norm(), row.removed});
  }
  write_whole_file(file, lower_extension(file) == ".vtk" ? vtk_of(points) : ply_of(points));
}

}  // namespace sulcus
