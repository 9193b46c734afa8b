#include "engine/scene/burr_number.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

// Komet: its FG diamonds by ISO number, with their lengths, as fossviking.com lists them
// (FG-Diamonds, 2019). Mr. Bur: "Dental Bur Classification and Numbering Systems" (mrbur.com,
// 2024). The standard itself was not at hand.
constexpr std::string_view kKomet = "Komet", kMrBur = "Mr. Bur", kBoth = "Komet, Mr. Bur";

constexpr std::array<BurrShapeNumber, 12> kNumbers{{
    {"001", BurrShape::kRound, 0.0, "ball", kBoth},
    {"010", BurrShape::kInvertedCone, 0.0, "inverted cone", kBoth},
    {"107", BurrShape::kFissure, 0.0, "cylinder, flat end", kKomet},
    {"110", BurrShape::kFissure, 6e-3, "cylinder, flat end", kKomet},
    {"111", BurrShape::kFissure, 8e-3, "cylinder, flat end", kKomet},
    {"233", BurrShape::kPear, 0.0, "pear", kKomet},
    {"237", BurrShape::kPear, 0.0, "pear", kBoth},
    {"243", BurrShape::kFlame, 0.0, "flame", kMrBur},
    {"247", BurrShape::kFlame, 5e-3, "flame", kKomet},
    {"248", BurrShape::kFlame, 6e-3, "flame", kKomet},
    {"249", BurrShape::kFlame, 8e-3, "flame", kKomet},
    {"250", BurrShape::kFlame, 10e-3, "flame", kKomet},
}};

// ISO 6360-1 and -3 as makers print them on their burrs: 806 galvanic and 807 sintered diamond, 500
// tungsten carbide.
constexpr std::array<std::pair<std::string_view, BurrMaterial>, 3> kMaterials{
    {{"806", BurrMaterial::kDiamond},
     {"807", BurrMaterial::kDiamond},
     {"500", BurrMaterial::kCarbide}}};
constexpr std::array<std::pair<std::string_view, Grit>, 4> kGrits{{{"514", Grit::kFine},
                                                                   {"524", Grit::kMedium},
                                                                   {"534", Grit::kCoarse},
                                                                   {"544", Grit::kSuperCoarse}}};

template <class Rows>
auto meaning_of(const Rows& rows, std::string_view digits) {
  const auto row = std::ranges::find(rows, digits, [](const auto& r) { return r.first; });
  std::optional<decltype(rows.front().second)> meaning;
  if (row != rows.end()) meaning = row->second;
  return meaning;
}

/// Material and grit of all 15 digits.
void read_edge(std::string_view digits, BurrNumber& number) {
  const std::string_view material = digits.substr(0, 3), grit = digits.substr(9, 3);
  number.material = meaning_of(kMaterials, material);
  if (!number.material) {
    number.unknown.append("material ").append(material);
  } else if (*number.material == BurrMaterial::kDiamond) {
    number.grit = meaning_of(kGrits, grit);
    if (!number.grit) number.unknown.append("grit ").append(grit);
  }
}

constexpr int kLeastSize = 3, kMostSize = 50;  // tenths of a millimetre, as burr.diameter_mm

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts) all.append(part);
  return all;
}

std::string known_numbers() {
  std::string all;
  for (const BurrShapeNumber& row : kNumbers) {
    all.append(all.empty() ? "" : ", ").append(row.number);
  }
  return all.append(" (sulcus help burrs)");
}

}  // namespace

std::span<const BurrShapeNumber> burr_shape_numbers() noexcept { return kNumbers; }

std::optional<BurrNumber> read_burr_number(std::string_view text, BurrNumberFault& fault) {
  std::string digits;
  for (const char c : text) {
    if (c != ' ') digits += c;
  }
  const bool plain = std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
  if (!plain || (digits.size() != 15 && digits.size() != 6)) {
    fault.found = joined({"\"", text, "\""});
    fault.expected =
        "15 digits of ISO 6360, \"806 314 001 524 014\", or shape and size, \"001 014\"";
    return {};
  }
  const bool whole = digits.size() == 15;
  if (const std::string shank = digits.substr(3, 3); whole && (shank < "313" || shank > "316")) {
    fault.found = joined({"shank ", shank});
    const std::string_view all = digits;
    fault.expected = joined({"313 to 316, friction grip; or shape and size alone, \"",
                             all.substr(6, 3), " ", all.substr(12, 3), "\""});
    return {};
  }
  const std::string shape = digits.substr(whole ? 6 : 0, 3);
  const auto* row = std::ranges::find(kNumbers, shape, &BurrShapeNumber::number);
  if (row == kNumbers.end()) {
    fault.found = joined({"shape ", shape});
    fault.expected = joined({"one of ", known_numbers()});
    return {};
  }
  const std::string size = digits.substr(whole ? 12 : 3, 3);
  const int tenths = std::stoi(size);
  if (tenths < kLeastSize || tenths > kMostSize) {
    fault.found = joined({"size ", size});
    fault.expected = "003 to 050, tenths of a millimetre";
    return {};
  }
  BurrNumber number{row->shape, tenths * 0.1 * kMillimetre, {}, {}, {}, {}};
  if (row->length_m > 0.0) number.length_m = row->length_m;
  if (whole) read_edge(digits, number);
  return number;
}

}  // namespace sulcus
