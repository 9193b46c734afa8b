#include "tools/sulcus_lab/normals/error_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/truth/error_stats.hpp"

namespace sulcus::lab {

namespace {

constexpr int kTile = 160;       // pixels along an edge
constexpr int kLargestTile = 6;  // neighbourhood
constexpr int kNothing = -1;

/// Which voxel each pixel shows, seen orthographically: kTile x kTile places in the shape's list of
/// voxels, row by row from below, kNothing beside the shape.
std::vector<int> visible_voxels(const TruthShape& shape) {
  // Three faces of both cubes are seen from here.
  const Eigen::Vector3d towards_eye = Eigen::Vector3d(0.4, 0.4, 0.82).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(towards_eye).normalized();
  const Eigen::Vector3d up = towards_eye.cross(right);
  Eigen::AlignedBox2d frame;
  for (const TruthVoxel& v : shape.voxels) {
    const Eigen::Vector3d p = v.cell.cast<double>();
    frame.extend(Eigen::Vector2d(p.dot(right), p.dot(up)));
  }
  const double scale = (kTile - 4) / std::max(1.0, frame.sizes().maxCoeff());  // pixels per voxel
  // A voxel covers what a ball about it does: no gap between neighbours at any view.
  const double radius = std::max(0.87 * scale, 0.71);
  std::vector<int> pixels(kTile * kTile, kNothing);
  std::vector<double> depth(pixels.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t v = 0; v < shape.voxels.size(); ++v) {
    const Eigen::Vector3d p = shape.voxels[v].cell.cast<double>();
    const Eigen::Vector2d at = (Eigen::Vector2d(p.dot(right), p.dot(up)) - frame.center()) * scale +
                               Eigen::Vector2d::Constant(0.5 * kTile);
    const int reach = static_cast<int>(std::ceil(radius));
    const int x0 = static_cast<int>(at.x()), y0 = static_cast<int>(at.y());
    for (int y = std::max(0, y0 - reach); y <= std::min(kTile - 1, y0 + reach); ++y) {
      for (int x = std::max(0, x0 - reach); x <= std::min(kTile - 1, x0 + reach); ++x) {
        const double off = (Eigen::Vector2d(x + 0.5, y + 0.5) - at).squaredNorm();
        if (off > radius * radius) continue;
        // The bulge of the ball gives the pixel to the voxel whose centre is nearest.
        const double d = p.dot(towards_eye) - off / (radius * radius);
        const std::size_t pixel = static_cast<std::size_t>(y * kTile + x);
        if (d <= depth[pixel]) continue;
        depth[pixel] = d;
        pixels[pixel] = static_cast<int>(v);
      }
    }
  }
  return pixels;
}

/// The voxels that are seen, as places in the shape's list.
std::vector<int> distinct(std::vector<int> pixels) {
  std::sort(pixels.begin(), pixels.end());
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  std::erase(pixels, kNothing);
  return pixels;
}

}  // namespace

bool write_error_tiles(const TruthShape& shape, std::span<const MethodRun> runs,
                       const std::string& file_csv) {
  std::vector<MethodRun> tiles(runs.begin(), runs.end());
  std::erase_if(tiles, [](const MethodRun& run) { return run.neighbourhood > kLargestTile; });
  if (tiles.empty()) return false;
  const std::vector<int> pixels = visible_voxels(shape);
  const std::vector<int> shown = distinct(pixels);

  const Workpiece workpiece{VoxelModel(shape.model)};
  const bool with_cloud = std::any_of(tiles.begin(), tiles.end(), [](const MethodRun& run) {
    return !info_of(run.method).finds_sign;
  });
  const NormalMethods methods(workpiece, with_cloud, shape.tool_direction);
  std::vector<Cell> cells;
  cells.reserve(shown.size());
  for (const int v : shown) cells.push_back(shape.voxels[static_cast<std::size_t>(v)].cell);
  const VoxelSample sample = methods.sample(std::move(cells));

  std::string header = "x,y";
  std::vector<std::string> cells_of(shape.voxels.size());  // of a line, by voxel
  std::vector<SurfaceEstimate> estimates;
  for (const MethodRun& tile : tiles) {
    header.append(",").append(info_of(tile.method).name).append("_");
    header += std::to_string(tile.neighbourhood);
    methods.estimate(tile.method, tile.neighbourhood, sample, estimates);
    for (std::size_t v = 0; v < shown.size(); ++v) {
      const auto voxel = static_cast<std::size_t>(shown[v]);
      const TruthVoxel& truth = shape.voxels[voxel];
      if (!info_of(tile.method).finds_sign) estimates[v] = turned_outward(estimates[v], truth);
      // Undefined shows as the worst there is.
      const float error = error_deg(estimates[v], truth, shape).value_or(180.0f);
      cells_of[voxel] += number_cell(",%.6g", static_cast<double>(error));
    }
  }
  CsvFile csv(file_csv, header);
  std::string beside;
  for (std::size_t t = 0; t < tiles.size(); ++t) beside += ",nan";
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    csv.write(std::to_string(p % kTile) + "," + std::to_string(p / kTile) +
              (pixels[p] == kNothing ? beside : cells_of[static_cast<std::size_t>(pixels[p])]));
  }
  return true;
}

}  // namespace sulcus::lab
