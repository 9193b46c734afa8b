#include "tools/sulcus_lab/normals/error_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"
#include "tools/sulcus_lab/truth/error_stats.hpp"

namespace sulcus::lab {

namespace {

constexpr int kTile = 160;  // pixels along an edge
constexpr int kLargestColumn = 6;
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

/// Data block of one tile: x, y, error; pixels without one are left out.
std::string tile_data(const std::vector<int>& pixels, const std::vector<float>& errors_deg) {
  std::string text;
  for (int y = 0; y < kTile; ++y) {
    for (int x = 0; x < kTile; ++x) {
      const int voxel = pixels[static_cast<std::size_t>(y * kTile + x)];
      const float error = voxel == kNothing ? std::numeric_limits<float>::quiet_NaN()
                                            : errors_deg[static_cast<std::size_t>(voxel)];
      text += number_for_gnuplot(static_cast<double>(error)) + (x + 1 < kTile ? " " : "\n");
    }
  }
  return text;
}

}  // namespace

bool draw_error_tiles(const TruthShape& shape, std::span<const MethodRun> runs,
                      const std::string& file_png) {
  const std::vector<int> pixels = visible_voxels(shape);
  std::vector<int> shown(pixels);
  std::sort(shown.begin(), shown.end());
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  std::erase(shown, kNothing);

  const Workpiece workpiece{VoxelModel(shape.model)};
  const bool with_cloud = std::any_of(
      runs.begin(), runs.end(), [](const MethodRun& r) { return !info_of(r.method).finds_sign; });
  const NormalMethods methods(workpiece, with_cloud, shape.tool_direction);
  std::vector<Cell> cells;
  cells.reserve(shown.size());
  for (const int v : shown) cells.push_back(shape.voxels[static_cast<std::size_t>(v)].cell);
  const VoxelSample sample = methods.sample(std::move(cells));

  std::vector<Method> lines;
  std::vector<int> columns;
  for (const MethodRun& run : runs) {
    if (run.neighbourhood > kLargestColumn) continue;
    if (std::find(lines.begin(), lines.end(), run.method) == lines.end())
      lines.push_back(run.method);
    if (std::find(columns.begin(), columns.end(), run.neighbourhood) == columns.end()) {
      columns.push_back(run.neighbourhood);
    }
  }
  if (lines.empty()) return true;  // nothing of that size was asked for
  std::sort(columns.begin(), columns.end());

  std::string data, plots;
  std::vector<SurfaceEstimate> estimates;
  std::vector<float> errors(shape.voxels.size());
  for (std::size_t line = 0; line < lines.size(); ++line) {
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const bool measured = std::any_of(runs.begin(), runs.end(), [&](const MethodRun& r) {
        return r.method == lines[line] && r.neighbourhood == columns[column];
      });
      if (!measured) continue;
      methods.estimate(lines[line], columns[column], sample, estimates);
      for (std::size_t v = 0; v < shown.size(); ++v) {
        const auto voxel = static_cast<std::size_t>(shown[v]);
        const TruthVoxel& truth = shape.voxels[voxel];
        if (!info_of(lines[line]).finds_sign) estimates[v] = turned_outward(estimates[v], truth);
        // Undefined shows as the worst there is.
        errors[voxel] = error_deg(estimates[v], truth, shape).value_or(180.0f);
      }
      const std::string name = "$t" + std::to_string(line) + "_" + std::to_string(columns[column]);
      data += name + " << EOD\n" + tile_data(pixels, errors) + "EOD\n";
      const auto x0 = static_cast<double>(column) * kTile;
      const auto y0 = static_cast<double>(lines.size() - 1 - line) * kTile;
      plots += name + " matrix using ($1+" + number_for_gnuplot(x0) + "):($2+" +
               number_for_gnuplot(y0) + "):($3 < 0.1 ? 0.1 : $3) with image notitle, ";
    }
  }

  std::string labels;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    labels += "set label 'NS = " + std::to_string(columns[column]) + "' at " +
              number_for_gnuplot((static_cast<double>(column) + 0.5) * kTile) + "," +
              number_for_gnuplot(static_cast<double>(lines.size()) * kTile + 12) +
              " center font 'sans,13' tc rgb '#111111'\n";
  }
  for (std::size_t line = 0; line < lines.size(); ++line) {
    labels += "set label '" + std::string(info_of(lines[line]).name) + "' at -8," +
              number_for_gnuplot((static_cast<double>(lines.size() - 1 - line) + 0.5) * kTile) +
              " right font 'sans,13' tc rgb '#111111'\n";
  }
  const int width = static_cast<int>(columns.size()) * kTile;
  const int height = static_cast<int>(lines.size()) * kTile;
  const int left = 175, right = 110, top = 70, bottom = 15;
  const auto fraction = [](int part, int whole) {
    return number_for_gnuplot(static_cast<double>(part) / static_cast<double>(whole));
  };
  const int full_width = width + left + right, full_height = height + top + bottom;
  const std::string commands =
      data + "set title " +
      for_gnuplot("Error of the normals on the " + spaced_name(shape.name) + ", degrees") +
      " offset 0,1.6 font 'sans,15' tc rgb '#111111'\n" + labels +
      "unset border\nunset tics\nset key off\n"
      "set lmargin at screen " +
      fraction(left, full_width) + "\n" + "set rmargin at screen " +
      fraction(left + width, full_width) + "\n" + "set bmargin at screen " +
      fraction(bottom, full_height) + "\n" + "set tmargin at screen " +
      fraction(bottom + height, full_height) + "\n" +
      "set xrange [-0.5:" + number_for_gnuplot(width - 0.5) + "]\n" +
      "set yrange [-0.5:" + number_for_gnuplot(height - 0.5) + "]\n" +
      // Viridis, light for little: equal steps for every eye, and grey prints keep the order.
      "set palette defined (0 '#fde725', 1 '#a0da39', 2 '#4ac16d', 3 '#1fa187', 4 '#277f8e',"
      " 5 '#365c8d', 6 '#46327e', 7 '#440154')\n"
      "set logscale cb\nset cbrange [0.1:90]\n"
      "set cbtics ('0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '1' 1, '2' 2, '5' 5, '10' 10, '20' 20,"
      " '45' 45, '90' 90) tc rgb '#111111'\n"
      "plot " +
      plots + "NaN notitle\n";
  return draw_chart(commands, full_width, full_height, file_png);
}

}  // namespace sulcus::lab
