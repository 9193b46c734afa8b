#include "engine/graphics/panels.hpp"

#include <algorithm>

#include <imgui.h>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr float kLeft = 18.0f, kTop = 100.0f, kWide = 250.0f;
constexpr float kSecond = 110.0f;    // of two in a row
constexpr float kScaleBar = 190.0f;  // left to it, in the corner below

void begin_side_panel(const char* name) {
  ImGui::SetNextWindowPos({kLeft, kTop});
  ImGui::SetNextWindowSize({kWide, 0.0f});
  ImGui::SetNextWindowBgAlpha(0.75f);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
  ImGui::PushItemWidth(-90.0f);
}

void end_panel() {
  ImGui::PopItemWidth();
  ImGui::End();
}

/// A list to choose from, which Escape closes; where it is open ImGui::EndCombo ends it.
bool begin_list(const char* label, const char* chosen) {
  if (!ImGui::BeginCombo(label, chosen)) return false;
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
  return true;
}

void draw_picture_controls(PictureControls& picture) {
  ImGui::Checkbox("Figures", &picture.figures);
  ImGui::SameLine(kSecond);
  ImGui::Checkbox("Arrows", &picture.arrows);
  ImGui::Checkbox("Tissues", &picture.legend);
  ImGui::SameLine(kSecond);
  ImGui::Checkbox("Mirror", &picture.mirror);
  if (picture.mirror) {
    ImGui::SliderFloat("down, deg", &picture.mirror_deg, -60.0f, 60.0f, "%.0f",
                       ImGuiSliderFlags_AlwaysClamp);
  }
  if (picture.has_plan) {
    ImGui::Checkbox("Plan", &picture.plan);
    ImGui::SameLine(kSecond);
    ImGui::Checkbox("Colours by plan", &picture.by_plan);
  }
  ImGui::Checkbox("Section at", &picture.cut_open);
  if (picture.cut_open) {
    constexpr const char* kAxes[] = {"x", "y", "z"};
    if (begin_list("axis", kAxes[picture.axis])) {
      for (int axis = 0; axis < 3; ++axis) {
        if (ImGui::Selectable(kAxes[axis], axis == picture.axis)) picture.axis = axis;
      }
      ImGui::EndCombo();
    }
    ImGui::SliderFloat("mm", &picture.at_mm, -10.0f, 10.0f, "%.2f", ImGuiSliderFlags_AlwaysClamp);
  }
}

/// Dark enough to be read on the panel. Where a scale of colours stands below it has no room.
void draw_help(const PictureControls& picture, const char* text) {
  if (picture.by_plan) return;
  ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(60, 66, 76, 255));
  ImGui::TextUnformatted(text);
  ImGui::PopStyleColor();
}

void draw_mark_list(PlayerControls& controls) {
  if (controls.marks.empty()) return;
  ImGui::Separator();
  ImGui::TextUnformatted("Not met");
  for (const PlayerControls::Mark& mark : controls.marks) {
    if (ImGui::SmallButton(mark.what.c_str())) {
      controls.time_s = mark.time_s;
      controls.playing = false;
    }
  }
}

/// On the item that was drawn last, which shows the time.
void draw_marks_on_timeline(const PlayerControls& controls) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const float grab = ImGui::GetStyle().GrabMinSize + 4.0f;  // whose middle stands for the time
  const float lasts_s = std::max(controls.end_s - controls.first_s, 1e-6f);
  for (const PlayerControls::Mark& mark : controls.marks) {
    const float part = (mark.time_s - controls.first_s) / lasts_s;
    const float x = low.x + 0.5f * grab + part * (high.x - low.x - grab);
    ImGui::GetWindowDrawList()->AddLine({x, low.y}, {x, high.y}, IM_COL32(200, 40, 40, 255), 2.0f);
  }
}

/// Spindle, burr and, of a device, where it lies.
void draw_hand_controls(LiveControls& controls) {
  ImGui::Checkbox("spindle (p)", &controls.spindle_on);
  float percent = 100.0f * controls.pedal;
  ImGui::SliderFloat("% speed", &percent, 0.0f, 100.0f, "%.0f", ImGuiSliderFlags_AlwaysClamp);
  controls.pedal = 0.01f * percent;
  if (!controls.burrs.empty() && begin_list("burr (b)", controls.burrs[controls.burr].c_str())) {
    for (std::size_t i = 0; i < controls.burrs.size(); ++i) {
      if (ImGui::Selectable(controls.burrs[i].c_str(), i == controls.burr)) controls.burr = i;
    }
    ImGui::EndCombo();
  }
  if (controls.by_mouse) return;
  ImGui::Checkbox("clutch (k)", &controls.clutch);
  ImGui::SameLine();
  if (ImGui::Button("recentre (r)")) controls.recentre_asked = true;
}

void draw_timing(const LiveControls& controls) {
  if (!controls.timing.empty()) ImGui::TextWrapped("%s", controls.timing.c_str());
  if (!controls.faults.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, {0.75f, 0.1f, 0.1f, 1.0f});
    ImGui::TextWrapped("%s", controls.faults.c_str());
    ImGui::PopStyleColor();
  }
}

}  // namespace

std::optional<Section> PictureControls::section() const {
  if (!cut_open) return {};
  return Section{axis, static_cast<double>(at_mm) * kMillimetre};
}

void draw_panels(PlayerControls& controls) {
  begin_side_panel("picture");
  draw_picture_controls(controls.picture);
  ImGui::SliderFloat("Speed", &controls.speed, -4.0f, 4.0f, "%.2f", ImGuiSliderFlags_AlwaysClamp);
  controls.export_asked = ImGui::Button("Export the tooth as it is here");
  if (!controls.said.empty()) ImGui::TextWrapped("%s", controls.said.c_str());
  draw_help(controls.picture,
            "drag: turn, with shift: move\nwheel: nearer to the pointer\n1-6, 0: cameras\n"
            "space: play, arrow keys: step\nc: copy place, d: caliper\nq, Esc: end");
  draw_mark_list(controls);
  end_panel();

  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({kLeft + kScaleBar, size.y - 52.0f});
  ImGui::SetNextWindowSize({size.x - 2.0f * kLeft - kScaleBar, 40.0f});
  ImGui::SetNextWindowBgAlpha(0.75f);
  ImGui::Begin("time", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
  if (ImGui::Button(controls.playing ? "Pause" : "Play", {60.0f, 0.0f})) {
    controls.playing = !controls.playing;
  }
  ImGui::SameLine();
  ImGui::PushItemWidth(-1.0f);
  ImGui::SliderFloat("##time", &controls.time_s, controls.first_s, controls.end_s, "%.3f s",
                     ImGuiSliderFlags_AlwaysClamp);
  draw_marks_on_timeline(controls);
  end_panel();
}

void draw_panels(LiveControls& controls) {
  begin_side_panel("picture");
  draw_picture_controls(controls.picture);
  ImGui::Separator();
  draw_hand_controls(controls);
  if (ImGui::Button(controls.paused ? "Resume" : "Pause", {70.0f, 0.0f})) {
    controls.paused = !controls.paused;
  }
  ImGui::SameLine();
  ImGui::Text("%.1f s", static_cast<double>(controls.time_s));
  const float most_s = std::max(0.0f, controls.time_s - controls.first_s);
  ImGui::SliderFloat("Rewind by", &controls.back_s, 0.0f, most_s, "%.1f s",
                     ImGuiSliderFlags_AlwaysClamp);
  if (ImGui::IsItemActive() && most_s > 0.0f) controls.looks_back = controls.paused = true;
  if (!controls.paused) controls.looks_back = false;
  ImGui::InputFloat("rpm", &controls.speed_rpm, 0.0f, 0.0f, "%.0f");
  constexpr float kMost_rpm = 500'000.0f;  // as in a scene
  controls.speed_rpm = std::clamp(controls.speed_rpm, 0.0f, kMost_rpm);
  ImGui::Checkbox("Change burr", &controls.other_burr);
  if (controls.other_burr) {
    if (begin_list("shape", controls.burr_shapes[controls.burr_shape].data())) {
      for (std::size_t i = 0; i < controls.burr_shapes.size(); ++i) {
        if (ImGui::Selectable(controls.burr_shapes[i].data(), i == controls.burr_shape)) {
          controls.burr_shape = i;
        }
      }
      ImGui::EndCombo();
    }
    ImGui::InputFloat("mm", &controls.burr_mm, 0.1f, 0.0f, "%.2f");
    controls.burr_mm = std::clamp(controls.burr_mm, controls.least_burr_mm, controls.most_burr_mm);
  }
  controls.go_on_asked = ImGui::Button("Rewind and continue");
  controls.save_asked = ImGui::Button("Save as a scene");
  if (!controls.said.empty()) ImGui::TextWrapped("%s", controls.said.c_str());
  draw_help(controls.picture,
            controls.by_mouse ? "left: burr, with shift: deeper,\nctrl: tilt; release: lifted off\n"
                                "right: turn, with shift: move\nwheel: nearer to the pointer\n"
                                "1-6, 0: cameras\nc: copy place, d: caliper\n"
                                "space: pause, q, Esc: end"
                              : "left: turn, with shift: move\nwheel: nearer to the pointer\n"
                                "1-6, 0: cameras\nc: copy place, d: caliper\n"
                                "space: pause, q, Esc: end");
  draw_timing(controls);
  end_panel();
}

}  // namespace sulcus
