#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "engine/graphics/camera.hpp"

namespace sulcus {

/// The part of a window that panels and figures leave free, in pixels from its edges.
struct WindowMargins {
  float left = 0.0f, right = 0.0f, top = 0.0f, bottom = 0.0f;
};

/// What a window shows over its picture. Places are right and up from the middle, in half heights
/// of the window.
struct Overlay {
  struct Words {
    Eigen::Vector2d place;
    std::string words;
  };
  struct Line {
    Eigen::Vector2d from, to;
  };
  struct Tissue {
    std::string name;
    std::array<float, 3> colour;  // linear RGB
  };
  std::vector<Words> labels;
  std::vector<Line> lines;             // with a cross at each end
  std::vector<Eigen::Vector2d> marks;  // crosses
  std::vector<Tissue> tissues;         // a legend
  std::vector<std::string> status;     // lines, in the middle of the top edge
  // The frame of an inset: its lower left corner in pixels of the window, and its size.
  std::optional<std::array<int, 4>> inset;
};

/// Between Window::begin and Window::end.
void draw_overlay(const Overlay& overlay, const WindowMargins& margins);

/// A letter for each side of the tooth that lies to a side of the picture: M, D, B, L, at its
/// edges. `aspect`: width by height; margins in pixels of a window so high.
std::vector<Overlay::Words> side_letters(const View& view, double aspect, double height,
                                         const WindowMargins& margins);

}  // namespace sulcus
