#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/graphics/hud_pen.hpp"

namespace sulcus {
namespace {

/// As the tooth's shader encodes it for the screen.
ImU32 screen_colour(const Eigen::Vector3f& linear) {
  const auto byte = [](float v) {
    return static_cast<int>(std::lround(255.0f * std::pow(std::clamp(v, 0.0f, 1.0f), 1 / 2.2f)));
  };
  return IM_COL32(byte(linear.x()), byte(linear.y()), byte(linear.z()), 255);
}

}  // namespace

void draw_colour_scale(const Pen& pen, int place, float tall, const ColourScale& scale) {
  constexpr float kWide = 196.0f, kBar = 150.0f, kBarWide = 18.0f;
  const float x = 18.0f + (kWide + 10.0f) * static_cast<float>(place);
  constexpr float kLetters = 15.0f, kTextWide = kWide - 20.0f;
  // A long name takes more lines, and the card grows up.
  const float text_tall =
      pen.font->CalcTextSizeA(kLetters * pen.scale, 1e6f, kTextWide * pen.scale, scale.name.c_str())
          .y /
      pen.scale;
  const float head = 21.0f + text_tall;
  const float top = tall - 76.0f - kBar - head;
  pen.list->AddRectFilled(pen.at(x, top), pen.at(x + kWide, top + kBar + head + 12.0f), kCard,
                          6.0f * pen.scale);
  pen.list->AddText(pen.font, kLetters * pen.scale, pen.at(x + 10, top + 6), kInk,
                    scale.name.c_str(), nullptr, kTextWide * pen.scale);
  const float low = top + head + kBar;
  constexpr int kBands = 100;
  for (int band = 0; band < kBands; ++band) {
    const float from = static_cast<float>(band) / kBands, to = from + 1.0f / kBands;
    pen.list->AddRectFilled(pen.at(x + 10, low - to * kBar),
                            pen.at(x + 10 + kBarWide, low - from * kBar),
                            screen_colour(scale.colour_at(0.5 * (from + to))));
  }
  for (const ColourScale::Mark& mark : scale.marks()) {
    const float y = low - static_cast<float>(mark.part) * kBar;
    pen.list->AddLine(pen.at(x + 10 + kBarWide, y), pen.at(x + 15 + kBarWide, y), kInk, pen.scale);
    pen.text(x + 20 + kBarWide, y - 8, kInk, mark.words, 13.0f);
  }
}

ColourScale contact_scale(const FrameState& state) {
  double most_N = 0.0;
  for (const ContactMark& mark : state.contact_marks) most_N = std::max(most_N, mark.force_N);
  constexpr double kLeast_N = 1e-6;  // where none has any
  return {.name = "Force of a voxel, mN",
          .high = round_number_above(std::max(most_N, kLeast_N)),
          .unit = 1e-3};
}

void draw_contact_marks(const Pen& pen, const FrameState& state, const View& view, float wide,
                        float tall, const ColourScale& scale) {
  std::vector<std::pair<float, const ContactMark*>> order;
  for (const ContactMark& mark : state.contact_marks) {
    order.emplace_back(view.back_world.dot(mark.centre_world.cast<float>()), &mark);
  }
  std::sort(order.begin(), order.end());
  constexpr float kLeast = 2.5f;  // pixels
  const auto edge =
      static_cast<float>(0.8 * state.contact_mark_m / (view.metres_per_pixel * pen.scale));
  const float half = 0.5f * std::max(edge, kLeast);
  for (const auto& [near, mark] : order) {
    const Eigen::Vector4f clip =
        view.clip_from_world * mark->centre_world.cast<float>().homogeneous().eval();
    if (clip.w() <= 0.0f) continue;
    const float x = 0.5f * wide * (1.0f + clip.x() / clip.w());
    const float y = 0.5f * tall * (1.0f - clip.y() / clip.w());
    if (x < -half || x > wide + half || y < -half || y > tall + half) continue;
    pen.list->AddRectFilled(pen.at(x - half, y - half), pen.at(x + half, y + half),
                            screen_colour(scale.colour(mark->force_N)));
  }
}

}  // namespace sulcus
