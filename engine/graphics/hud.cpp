#include "engine/graphics/hud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "engine/core/units.hpp"
#include "engine/graphics/hud_pen.hpp"

namespace sulcus {
namespace {

constexpr ImU32 kForce = IM_COL32(32, 98, 178, 255);
constexpr ImU32 kTorque = IM_COL32(196, 94, 18, 255);
constexpr ImU32 kTick = IM_COL32(28, 128, 84, 255);
constexpr ImU32 kSpeed = IM_COL32(107, 74, 160, 255);
constexpr ImU32 kPulp = IM_COL32(150, 34, 60, 255);
constexpr ImU32 kLimit = IM_COL32(190, 40, 40, 220);
constexpr double kTickBudget_us = 1000.0;

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

struct Curve {
  const char* name;
  std::string value;
  std::span<const float> history;
  ImU32 colour;
  double top;  // of the axis
  bool logarithmic = false;
};

constexpr float kCardWidth = 236.0f;

void draw_curve(const Pen& pen, float x, float y, float card_height, const Curve& curve) {
  pen.list->AddRectFilled(pen.at(x, y), pen.at(x + kCardWidth, y + card_height), kCard,
                          6.0f * pen.scale);
  pen.text(x + 10, y + 6, kInk, curve.name);
  pen.text_right(x + kCardWidth - 10, y + 6, curve.colour, curve.value);
  const float left = x + 10, right = x + kCardWidth - 10;
  const float low = y + card_height - 10, high = y + 32;
  constexpr double kBottom = 1.0;  // of a logarithmic axis
  auto height = [&](double value) {
    const double part = curve.logarithmic ? std::log(std::max(value, kBottom) / kBottom) /
                                                std::log(curve.top / kBottom)
                                          : value / curve.top;
    return low - static_cast<float>(std::clamp(part, 0.0, 1.0)) * (low - high);
  };
  if (curve.logarithmic) {
    for (double v = 10.0; v < curve.top; v *= 10.0) {
      const bool limit = v == kTickBudget_us;
      pen.list->AddLine(pen.at(left, height(v)), pen.at(right, height(v)), limit ? kLimit : kGrid,
                        pen.scale);
    }
    pen.text(left, height(kTickBudget_us) - 13, kLimit, "1 ms", 11.0f);
  } else {
    for (const double v : {0.0, 0.5 * curve.top, curve.top}) {
      pen.list->AddLine(pen.at(left, height(v)), pen.at(right, height(v)), kGrid, pen.scale);
    }
    pen.text(left, high - 1, kFaint, format("%g", curve.top), 11.0f);
  }
  if (curve.history.size() < 2) return;
  // A point for every two pixels at most: the largest of the ticks that fall on them, so no peak is
  // lost.
  const auto count = curve.history.size();
  const auto columns =
      std::min<std::size_t>(count, static_cast<std::size_t>((right - left) * pen.scale / 2.0f));
  std::vector<ImVec2> points;
  points.reserve(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t from = c * count / columns;
    const std::size_t to = (c + 1) * count / columns;
    double peak = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      if (std::isfinite(curve.history[i])) {
        peak = std::max(peak, static_cast<double>(curve.history[i]));
      }
    }
    const float along = static_cast<float>(c) / static_cast<float>(columns - 1);
    points.push_back(pen.at(left + along * (right - left), height(peak)));
  }
  pen.list->AddPolyline(points.data(), static_cast<int>(points.size()), curve.colour,
                        ImDrawFlags_None, 1.6f * pen.scale);
}

double axis_top(std::span<const float> history, double least) {
  double top = least;
  for (const float v : history) {
    if (std::isfinite(v)) top = std::max(top, static_cast<double>(v));
  }
  return round_number_above(top);
}

/// Contacts, what was removed, and what came of it; the lower end of the card.
float draw_outcome(const Pen& pen, float x, float y, const FrameState& state) {
  constexpr float kRow = 22.0f;
  std::vector<OutcomeLine> lines{{"Contacts", format("%u", state.contacts)},
                                 {"Removed", format("%.3f mm\xC2\xB3", state.removed_mm3)}};
  lines.insert(lines.end(), state.outcome.begin(), state.outcome.end());
  const float bottom = y + 10 + kRow * static_cast<float>(lines.size());
  pen.list->AddRectFilled(pen.at(x, y), pen.at(x + kCardWidth, bottom), kCard, 6.0f * pen.scale);
  for (const OutcomeLine& line : lines) {
    pen.text(x + 10, y + 6, kInk, line.name);
    pen.text_right(x + kCardWidth - 10, y + 6, kInk, line.value);
    y += kRow;
  }
  return bottom;
}

constexpr float kStageRow = 24.0f;

/// What a tick spends its time on, a bar to each stage, the longest as wide as the card.
void draw_stages(const Pen& pen, float x, float y, const std::vector<StageTime>& stages) {
  if (stages.empty()) return;
  double longest_us = 1e-3;
  for (const StageTime& stage : stages) longest_us = std::max(longest_us, stage.us);
  const float height = 10 + kStageRow * static_cast<float>(stages.size());
  pen.list->AddRectFilled(pen.at(x, y), pen.at(x + kCardWidth, y + height), kCard,
                          6.0f * pen.scale);
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const float top = y + 5 + kStageRow * static_cast<float>(s);
    const float wide = (kCardWidth - 20) * static_cast<float>(stages[s].us / longest_us);
    pen.list->AddRectFilled(pen.at(x + 10, top + kStageRow - 5),
                            pen.at(x + 10 + wide, top + kStageRow - 3), kTick);
    pen.text(x + 10, top, kInk, stages[s].name);
    pen.text_right(x + kCardWidth - 10, top, kInk, format("%.1f \xC2\xB5s", stages[s].us));
  }
}

void draw_scale_bar(const Pen& pen, float bottom, double metres_per_pixel) {
  const double per_unit_mm = metres_per_pixel * pen.scale / kMillimetre;
  const double length_mm = round_number_above(70.0 * per_unit_mm);
  const float wide = static_cast<float>(length_mm / per_unit_mm);
  const float x = 24, y = bottom - 26;
  pen.list->AddRectFilled(pen.at(x, y), pen.at(x + wide, y + 4), kInk);
  for (const float end : {x, x + wide - 2}) {
    pen.list->AddRectFilled(pen.at(end, y - 5), pen.at(end + 2, y + 4), kInk);
  }
  pen.text(x, y - 26, kInk, format("%g mm", length_mm));
}

/// From the burr's tip along a vector of the world, as long as it says, seen as the picture is.
/// `heads`: 1 for a force, 2 for a torque, whose direction is its axis.
void draw_arrow(const Pen& pen, ImVec2 from, ImVec2 way, float length, int heads, ImU32 colour,
                const std::string& value) {
  const ImVec2 to(from.x + length * way.x, from.y + length * way.y);
  const ImU32 edge = IM_COL32(255, 255, 255, 200);
  pen.list->AddLine(pen.at(from.x, from.y), pen.at(to.x, to.y), edge, 7.0f * pen.scale);
  pen.list->AddLine(pen.at(from.x, from.y), pen.at(to.x, to.y), colour, 4.0f * pen.scale);
  for (int head = 0; head < heads; ++head) {
    const float back = 11.0f * static_cast<float>(head);
    const ImVec2 tip(to.x + (9.0f - back) * way.x, to.y + (9.0f - back) * way.y);
    const ImVec2 root(tip.x - 16.0f * way.x, tip.y - 16.0f * way.y);
    pen.list->AddTriangleFilled(pen.at(tip.x, tip.y),
                                pen.at(root.x + 8.0f * way.y, root.y - 8.0f * way.x),
                                pen.at(root.x - 8.0f * way.y, root.y + 8.0f * way.x), colour);
  }
  // Beyond the head, whichever way it points.
  const ImVec2 beyond(to.x + 20.0f * way.x, to.y + 20.0f * way.y - 8.0f);
  if (way.x < 0.0f) {
    pen.text_right(beyond.x, beyond.y, colour, value);
  } else {
    pen.text(beyond.x, beyond.y, colour, value);
  }
}

void draw_arrows(const Pen& pen, const FrameState& state, const View& view, float wide,
                 float tall) {
  const Eigen::Vector3f tip = state.world_from_tool.position.cast<float>();
  const Eigen::Vector4f clip = view.clip_from_world * tip.homogeneous().eval();
  if (clip.w() <= 0.0f) return;
  const ImVec2 from(0.5f * wide * (1.0f + clip.x() / clip.w()),
                    0.5f * tall * (1.0f - clip.y() / clip.w()));
  constexpr double kShortest = 14.0;  // pixels: an arrow's head
  const auto draw = [&](const Eigen::Vector3d& vector, double pixels, int heads, ImU32 colour,
                        const std::string& value) {
    const Eigen::Vector3f v = vector.cast<float>();
    const float right = v.dot(view.right_world), up = v.dot(view.up_world);
    const float seen = std::hypot(right, up);
    // One that comes straight at the eye has no direction in the picture, and less than a tenth of
    // an arrow's head is as good as nothing.
    constexpr double kAcross = 0.2, kLeast = 0.1 * kShortest;
    if (seen < kAcross * vector.norm() || seen * pixels < kLeast) return;
    const auto length =
        static_cast<float>(std::clamp(seen * pixels, kShortest, std::max(kShortest, 0.4 * tall)));
    draw_arrow(pen, from, ImVec2(right / seen, -up / seen), length, heads, colour, value);
  };
  constexpr double kPixelsPerNewton = 80.0, kPixelsPerNewtonMetre = 2000.0;
  draw(state.force_N, kPixelsPerNewton, 1, kForce, format("%.2f N", state.force_N.norm()));
  draw(state.torque_Nm, kPixelsPerNewtonMetre, 2, kTorque,
       format("%.1f mN m", 1e3 * state.torque_Nm.norm()));
}

/// What a scene has besides.
void add_optional_curves(const FrameState& state, std::vector<Curve>& curves) {
  if (const auto& history = state.spindle_history_krpm; !history.empty()) {
    curves.push_back({.name = "Speed",
                      .value = format("%.1f krpm", static_cast<double>(history.back())),
                      .history = history,
                      .colour = kSpeed,
                      .top = axis_top(history, 10.0)});
  }
  if (const auto& history = state.pulp_history_mm;
      !history.empty() && std::isfinite(history.back())) {
    curves.push_back({.name = "Over the pulp",
                      .value = format("%.2f mm", static_cast<double>(history.back())),
                      .history = history,
                      .colour = kPulp,
                      .top = axis_top(history, 1.0)});
  }
}

void draw_figures(const Pen& pen, const FrameState& state, float wide, float tall) {
  const float x = wide - kCardWidth - 18;
  float y = 18;
  std::vector<Curve> curves{{.name = "Force",
                             .value = format("%.2f N", state.force_N.norm()),
                             .history = state.force_history_N,
                             .colour = kForce,
                             .top = axis_top(state.force_history_N, 0.5)},
                            {.name = "Torque",
                             .value = format("%.2f mN m", 1e3 * state.torque_Nm.norm()),
                             .history = state.torque_history_mNm,
                             .colour = kTorque,
                             .top = axis_top(state.torque_history_mNm, 5.0)},
                            {.name = "Tick",
                             .value = format("%.0f \xC2\xB5s", state.tick_us),
                             .history = state.tick_history_us,
                             .colour = kTick,
                             .top = 10.0 * kTickBudget_us,
                             .logarithmic = true}};
  add_optional_curves(state, curves);
  // More than three are lower, so that the figures below have their room.
  const float card_height = curves.size() > 3 ? 70.0f : 104.0f;
  for (const Curve& curve : curves) {
    draw_curve(pen, x, y, card_height, curve);
    y += card_height + 10;
  }
  y = draw_outcome(pen, x, y, state);
  if (y + 20 + kStageRow * static_cast<float>(state.stages.size()) < tall) {
    draw_stages(pen, x, y + 10, state.stages);
  }
}

}  // namespace

Hud::Hud(int frame_height) : scale_(static_cast<float>(frame_height) / 720.0f) {
  IMGUI_CHECKVERSION();
  ImGuiContext* const previous = ImGui::GetCurrentContext();
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // a window's place in some file must not change a picture
  io.LogFilename = nullptr;
  io.Fonts->Flags |= ImFontAtlasFlags_NoMouseCursors;
  // The font of the system where there is one, since ImGui's own has one size of 13 pixels.
  const char* const font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  if (std::filesystem::exists(font)) {
    // A font has a pixel at least; in so small a picture nobody reads it.
    const auto pixels = [&](float at_720) { return std::max(1.0f, std::round(at_720 * scale_)); };
    text_ = io.Fonts->AddFontFromFileTTF(font, pixels(15.0f));
    title_ = io.Fonts->AddFontFromFileTTF(font, pixels(21.0f));
  }
  if (text_ == nullptr || title_ == nullptr) text_ = title_ = io.Fonts->AddFontDefault();
  ImGui_ImplOpenGL3_Init("#version 330 core");
  ImGui::SetCurrentContext(previous);
}

Hud::~Hud() {
  ImGuiContext* const previous = ImGui::GetCurrentContext();
  ImGui::SetCurrentContext(context_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext(context_);
  ImGui::SetCurrentContext(previous == context_ ? nullptr : previous);
}

void Hud::draw(const FrameState& state, int width, int height, const View& view,
               const HudParts& parts, const ColourScale* colours) {
  ImGuiContext* const previous = ImGui::GetCurrentContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = 1.0f / 60.0f;  // no clock
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  const Pen pen{ImGui::GetBackgroundDrawList(), text_, title_, scale_};
  const float wide = static_cast<float>(width) / scale_;
  const float tall = static_cast<float>(height) / scale_;
  int scales = 0;
  if (colours != nullptr && parts.scales) draw_colour_scale(pen, scales++, tall, *colours);
  if (!state.contact_marks.empty()) {
    const ColourScale forces = contact_scale(state);
    draw_contact_marks(pen, state, view, wide, tall, forces);
    if (parts.scales) draw_colour_scale(pen, scales, tall, forces);
  }
  if (parts.arrows) draw_arrows(pen, state, view, wide, tall);
  if (parts.title) {
    pen.text(24, 18, kInk, state.title, 21.0f);
    pen.text(24, 48, kFaint, format("%.3f s", state.time_s));
    pen.text(24, 68, kFaint, format("tick %llu", static_cast<unsigned long long>(state.tick)));
    draw_scale_bar(pen, tall, view.metres_per_pixel);
  }
  if (parts.figures) draw_figures(pen, state, wide, tall);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (previous) ImGui::SetCurrentContext(previous);
}

}  // namespace sulcus
