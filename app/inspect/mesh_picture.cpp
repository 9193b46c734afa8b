#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "app/inspect/mesh_facts.hpp"
#include "app/inspect/section_plot.hpp"
#include "app/inspect/suggested_run.hpp"
#include "app/report/gnuplot.hpp"
#include "engine/core/units.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

namespace {

constexpr int kMeshWidth = 1500, kMeshHeight = 700;
constexpr double kLeft = 70.0, kApart = 75.0, kRight = 25.0, kOver = 90.0, kBelow = 70.0;  // pixels
constexpr double kMeshMargin = 0.05;  // of the longest side, about the mesh
constexpr const char* kMarkColour = "#d62728";

/// Along which axis it is seen: columns run along `u`, rows along `v`, the eye is on the side of
/// `towards` (1 or -1) of `depth`.
struct MeshView {
  const char* from;
  int u, v, depth;
  double towards;
};
constexpr std::array<MeshView, 3> kMeshViews{{
    {"from above", 0, 1, 2, 1.0},
    {"from the front", 0, 2, 1, -1.0},
    {"from the side", 1, 2, 0, 1.0},
}};

/// Greys of a mesh as it is seen, lit from the eye and a little from above; 2 where it is not.
class MeshShades {
 public:
  MeshShades(const MeshView& view, const Eigen::AlignedBox3d& shown_mm, double pixels_per_mm)
      : view_(view), low_(shown_mm.min()[view.u], shown_mm.min()[view.v]) {
    plane_.columns =
        std::max(2, static_cast<int>(std::lround(shown_mm.sizes()[view.u] * pixels_per_mm)));
    plane_.rows =
        std::max(2, static_cast<int>(std::lround(shown_mm.sizes()[view.v] * pixels_per_mm)));
    plane_.step_x = shown_mm.sizes()[view.u] / plane_.columns;
    plane_.step_y = shown_mm.sizes()[view.v] / plane_.rows;
    plane_.x0 = low_.x() + 0.5 * plane_.step_x;
    plane_.y0 = low_.y() + 0.5 * plane_.step_y;
    const auto size =
        static_cast<std::size_t>(plane_.columns) * static_cast<std::size_t>(plane_.rows);
    shades_.assign(size, kNothing);
    depths_.assign(size, -std::numeric_limits<double>::max());
  }

  void add(const std::array<Eigen::Vector3d, 3>& corners_mm) {
    const Eigen::Vector3d normal =
        (corners_mm[1] - corners_mm[0]).cross(corners_mm[2] - corners_mm[0]);
    if (!(normal.norm() > 0.0)) return;
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    light[view_.depth] = view_.towards;
    light[view_.v] = 0.45;
    light[view_.u] = -0.35;
    // Whichever way round it is: what is seen of an open or inverted mesh is lit as well.
    const double facing = normal[view_.depth] * view_.towards < 0.0 ? -1.0 : 1.0;
    const double lit = facing * normal.dot(light) / (normal.norm() * light.norm());
    fill(corners_mm, 0.15 + 0.8 * std::max(0.0, lit));
  }

  PlaneValues plane() const {
    PlaneValues plane = plane_;
    plane.at = [this](int column, int row) { return shades_[place(column, row)]; };
    return plane;
  }

 private:
  static constexpr double kNothing = 2.0;

  std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(plane_.columns) +
           static_cast<std::size_t>(column);
  }

  void fill(const std::array<Eigen::Vector3d, 3>& corners_mm, double shade) {
    std::array<Eigen::Vector2d, 3> p;  // in points of the plane
    Eigen::AlignedBox2d box;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = {(corners_mm[i][view_.u] - plane_.x0) / plane_.step_x,
              (corners_mm[i][view_.v] - plane_.y0) / plane_.step_y};
      box.extend(p[i]);
    }
    const auto across = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return a.x() * b.y() - a.y() * b.x();
    };
    const double area = across(p[1] - p[0], p[2] - p[0]);
    if (area == 0.0) return;
    const int first_column = std::max(0, static_cast<int>(std::ceil(box.min().x())));
    const int first_row = std::max(0, static_cast<int>(std::ceil(box.min().y())));
    const int last_column =
        std::min(plane_.columns - 1, static_cast<int>(std::floor(box.max().x())));
    const int last_row = std::min(plane_.rows - 1, static_cast<int>(std::floor(box.max().y())));
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column) {
        const Eigen::Vector2d q(column, row);
        const double a = across(p[1] - q, p[2] - q) / area, b = across(p[2] - q, p[0] - q) / area;
        const double c = 1.0 - a - b;
        if (a < 0.0 || b < 0.0 || c < 0.0) continue;
        const double depth =
            view_.towards * (a * corners_mm[0][view_.depth] + b * corners_mm[1][view_.depth] +
                             c * corners_mm[2][view_.depth]);
        if (depth <= depths_[place(column, row)]) continue;
        depths_[place(column, row)] = depth;
        shades_[place(column, row)] = shade;
      }
    }
  }

  MeshView view_;
  Eigen::Vector2d low_;
  PlaneValues plane_;
  std::vector<double> shades_, depths_;
};

void put_view(std::FILE* gnuplot, const MeshView& view, const MeshShades& shades,
              const PlotFrame& frame, const Eigen::AlignedBox3d& shown_mm,
              const Eigen::Vector3d& top_mm) {
  put_frame(gnuplot, frame, kMeshWidth, kMeshHeight);
  std::fprintf(gnuplot,
               "set title '%s' offset 0, -0.5\nset xlabel '%c, mm'\nset ylabel '%c, mm' offset 1\n"
               "set xrange [%.8g:%.8g]\nset yrange [%.8g:%.8g]\n"
               "plot '-' using 1:2:3 with image, '-' with points pt 1 ps 2.5 lw 2 lc rgb '%s'\n",
               view.from, "xyz"[view.u], "xyz"[view.v], shown_mm.min()[view.u],
               shown_mm.max()[view.u], shown_mm.min()[view.v], shown_mm.max()[view.v], kMarkColour);
  put_values(gnuplot, shades.plane());
  std::fprintf(gnuplot, "%.6g %.6g\ne\n", top_mm[view.u], top_mm[view.v]);
}

}  // namespace

bool draw_mesh(const TriangleMesh& mesh, const MeshFacts& facts, const std::string& name,
               const std::string& file_png) {
  const Eigen::Vector3d half_mm = 0.5 * facts.box_file_m.sizes() / kMillimetre;
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(2.0 * kMeshMargin * half_mm.maxCoeff());
  const Eigen::AlignedBox3d shown_mm(Eigen::Vector3d(-half_mm - margin),
                                     Eigen::Vector3d(half_mm + margin));
  const Eigen::Vector3d size = shown_mm.sizes();
  const double pixels_per_mm =
      std::min((kMeshWidth - kLeft - 2.0 * kApart - kRight) / (2.0 * size.x() + size.y()),
               (kMeshHeight - kOver - kBelow) / std::max(size.y(), size.z()));
  const Eigen::Vector3d top_mm = facts.highest_scene_m / kMillimetre;
  return draw_with_gnuplot(file_png, kMeshWidth, kMeshHeight, [&](std::FILE* gnuplot) {
    std::fprintf(
        gnuplot,
        "set multiplot\nset label 9 %s at screen 0.5, 0.965 center textcolor rgb "
        "'#444444'\nset label 8 'space of the scene; +: the highest place, %s mm' at "
        "screen 0.5, 0.93 center textcolor rgb '%s'\n"
        "set key off\nunset colorbox\nset border 15 lc rgb '#888888'\nset tics out nomirror "
        "textcolor rgb '#444444'\nset grid front lt 1 lw 0.5 lc rgb '#b04060a0'\n"
        "set palette defined (0 '#101820', 1 '#f4efe4', 1.001 '#ffffff', 2 '#ffffff')\n"
        "set cbrange [0:2]\n",
        for_gnuplot(name).c_str(), short_triple(top_mm).c_str(), kMarkColour);
    double left = kLeft;
    for (const MeshView& view : kMeshViews) {
      MeshShades shades(view, shown_mm, pixels_per_mm);
      for (const auto& triangle : mesh.triangles) {
        std::array<Eigen::Vector3d, 3> corners_mm;
        for (std::size_t i = 0; i < 3; ++i) {
          corners_mm[i] =
              facts.scene_from_file(mesh.positions[triangle[i]].cast<double>()) / kMillimetre;
        }
        shades.add(corners_mm);
      }
      const double width = size[view.u] * pixels_per_mm, height = size[view.v] * pixels_per_mm;
      put_view(gnuplot, view, shades, {left, kMeshHeight - kOver - height, width, height}, shown_mm,
               top_mm);
      std::fputs("unset label\n", gnuplot);
      left += width + kApart;
    }
    std::fputs("unset multiplot\n", gnuplot);
  });
}

}  // namespace sulcus
