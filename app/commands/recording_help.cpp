#include "app/commands/recording_help.hpp"

#include <array>
#include <string_view>

#include "app/commands/scene_help.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kNameColumns = 24, kColumns = 100;

std::string_view kind_of(const StoredPart& part) {
  switch (part.kind) {
    case StoredKind::kRows:
      return "rows";
    case StoredKind::kRow:
      return "one row";
    case StoredKind::kArray:
      return "array";
    case StoredKind::kGroup:
      break;
  }
  return part.fields.empty() ? "group" : "group with attributes";
}

}  // namespace

std::string text_of(const StoredPart& part) {
  std::string text(kind_of(part));
  if (!part.when.empty()) text.append(", only ").append(part.when);
  text.append(": ").append(part.what);
  if (!part.like.empty()) text.append("; it has all that ").append(part.like).append(" has");
  return text;
}

std::string values_of(const StoredField& field) {
  constexpr std::array<std::string_view, 7> kNames{"u8", "u16", "u32", "u64", "f32", "f64", "text"};
  std::string text(kNames[static_cast<std::size_t>(field.type)]);
  if (field.count > 1) text.append("[").append(std::to_string(field.count)).append("]");
  if (!field.unit.empty()) text.append(", ").append(field.unit);
  return text;
}

std::string recording_notes() {
  return "A recording is HDF5. Numbers are little-endian: u8 to u64 without a sign, f32 and f64 of "
         "IEEE 754. Rows are compounds, whose fields are columns. World: the origin is the centre "
         "of the workpiece's grid. A recording whose program was killed opens in the mode of a "
         "single writer and multiple readers only; sulcus repair makes one that opens everywhere. "
         "The last rows of such a one may be torn: each has a check.";
}

std::string recording_examples() {
  return "  import h5py                                               # Python\n"
         "  with h5py.File(\"recording.h5\", \"r\", swmr=True) as f:\n"
         "      scene = f.attrs[\"scene\"].decode()\n"
         "      ticks, edits = f[\"ticks\"][:], f[\"edits\"][:]\n"
         "  force_N = ticks[\"force_N\"]                                # rows x 3\n"
         "\n"
         "  scene = h5readatt('recording.h5', '/', 'scene');          % MATLAB, closed recordings\n"
         "  ticks = h5read('recording.h5', '/ticks');                 % a struct of columns\n";
}

std::string recording_help() {
  std::string out = wrapped(recording_notes(), 0, kColumns) + "\n\n" + recording_examples();
  for (const StoredPart& part : recording_layout()) {
    const std::string path(part.path);
    out.append("\n").append(path).append("  ");
    out.append(wrapped(text_of(part), path.size() + 2, kColumns)).append("\n");
    for (const StoredField& field : part.fields) {
      std::string line = "  " + std::string(field.name);
      line.append(line.size() + 2 > kNameColumns ? 2 : kNameColumns - line.size(), ' ');
      line.append(values_of(field)).append(field.what.empty() ? "" : ": ");
      out.append(line).append(wrapped(std::string(field.what), line.size(), kColumns)).append("\n");
    }
  }
  return out;
}

}  // namespace sulcus
