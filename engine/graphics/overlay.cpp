#include "engine/graphics/overlay.hpp"

#include <algorithm>
#include <cmath>

#include <imgui.h>

namespace sulcus {

namespace {

constexpr ImU32 kInk = IM_COL32(24, 30, 40, 255), kHalo = IM_COL32(255, 255, 255, 230),
                kPaper = IM_COL32(255, 255, 255, 200), kLine = IM_COL32(170, 30, 110, 255);

ImU32 screen_colour(const std::array<float, 3>& linear) {
  const auto byte = [&](std::size_t i) {
    return static_cast<int>(
        std::lround(255.0f * std::pow(std::clamp(linear[i], 0.0f, 1.0f), 1 / 2.2f)));
  };
  return IM_COL32(byte(0), byte(1), byte(2), 255);
}

/// Places of an overlay as pixels of the window.
struct Sheet {
  ImVec2 size = ImGui::GetIO().DisplaySize;
  ImDrawList* list = ImGui::GetBackgroundDrawList();

  ImVec2 at(const Eigen::Vector2d& place) const {
    const float half = 0.5f * size.y;
    return {0.5f * size.x + half * static_cast<float>(place.x()),
            half - half * static_cast<float>(place.y())};
  }
  void cross(const ImVec2& p) const {
    for (const auto& [colour, wide] : {std::pair{kHalo, 4.0f}, std::pair{kLine, 2.0f}}) {
      list->AddLine({p.x - 7.0f, p.y}, {p.x + 7.0f, p.y}, colour, wide);
      list->AddLine({p.x, p.y - 7.0f}, {p.x, p.y + 7.0f}, colour, wide);
    }
  }
  /// In the middle of `p`, on paper, within the window.
  void words(ImVec2 p, const std::string& text, float font_size) const {
    const ImVec2 wide = ImGui::GetFont()->CalcTextSizeA(font_size, 1e6f, 0.0f, text.c_str());
    p = {std::clamp(p.x - 0.5f * wide.x, 6.0f, size.x - wide.x - 6.0f),
         std::clamp(p.y - 0.5f * wide.y, 4.0f, size.y - wide.y - 4.0f)};
    list->AddRectFilled({p.x - 5.0f, p.y - 2.0f}, {p.x + wide.x + 5.0f, p.y + wide.y + 2.0f},
                        kPaper, 4.0f);
    list->AddText(ImGui::GetFont(), font_size, p, kInk, text.c_str());
  }
};

void draw_legend(const Sheet& sheet, const std::vector<Overlay::Tissue>& tissues,
                 const WindowMargins& margins) {
  if (tissues.empty()) return;
  constexpr float kRow = 20.0f, kSwatch = 14.0f, kFont = 15.0f;
  float wide = 0.0f;
  for (const Overlay::Tissue& tissue : tissues) {
    wide =
        std::max(wide, ImGui::GetFont()->CalcTextSizeA(kFont, 1e6f, 0.0f, tissue.name.c_str()).x);
  }
  wide += kSwatch + 26.0f;
  const float height = 10.0f + kRow * static_cast<float>(tissues.size());
  const float x = sheet.size.x - margins.right - wide;
  float y = sheet.size.y - margins.bottom - height;
  sheet.list->AddRectFilled({x, y}, {x + wide, y + height}, kPaper, 6.0f);
  y += 7.0f;
  for (const Overlay::Tissue& tissue : tissues) {
    sheet.list->AddRectFilled({x + 8.0f, y}, {x + 8.0f + kSwatch, y + kSwatch},
                              screen_colour(tissue.colour), 3.0f);
    sheet.list->AddRect({x + 8.0f, y}, {x + 8.0f + kSwatch, y + kSwatch}, kInk, 3.0f);
    sheet.list->AddText(ImGui::GetFont(), kFont, {x + kSwatch + 16.0f, y - 1.0f}, kInk,
                        tissue.name.c_str());
    y += kRow;
  }
}

}  // namespace

void draw_overlay(const Overlay& overlay, const WindowMargins& margins) {
  const Sheet sheet;
  for (const Overlay::Line& line : overlay.lines) {
    const ImVec2 from = sheet.at(line.from), to = sheet.at(line.to);
    sheet.list->AddLine(from, to, kHalo, 4.0f);
    sheet.list->AddLine(from, to, kLine, 2.0f);
    sheet.cross(from);
    sheet.cross(to);
  }
  for (const Eigen::Vector2d& mark : overlay.marks) sheet.cross(sheet.at(mark));
  for (const Overlay::Words& label : overlay.labels) {
    sheet.words(sheet.at(label.place), label.words, 17.0f);
  }
  draw_legend(sheet, overlay.tissues, margins);
  if (overlay.inset) {
    const auto& [x, low, wide, tall] = *overlay.inset;
    const ImVec2 corner(static_cast<float>(x), sheet.size.y - static_cast<float>(low + tall));
    const ImVec2 other(corner.x + static_cast<float>(wide), corner.y + static_cast<float>(tall));
    sheet.list->AddRect(corner, other, kHalo, 8.0f, 0, 6.0f);
    sheet.list->AddRect(corner, other, kInk, 8.0f, 0, 1.5f);
    sheet.list->AddText(ImGui::GetFont(), 14.0f, {corner.x + 8.0f, corner.y + 6.0f}, kInk,
                        "mirror");
  }
  float y = margins.top + 14.0f;
  for (const std::string& line : overlay.status) {
    const float middle = margins.left + 0.5f * (sheet.size.x - margins.left - margins.right);
    sheet.words({middle, y}, line, 15.0f);
    y += 22.0f;
  }
}

}  // namespace sulcus
