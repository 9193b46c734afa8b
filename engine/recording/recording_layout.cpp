#include "engine/recording/recording_layout.hpp"

#include <array>

#include "engine/core/fault.hpp"

namespace sulcus {

namespace {

using enum StoredType;

/// "bits: 1 ..., 2 ..., ...", of every fault.
struct FaultBits {
  std::array<char, 1000> text{};
  std::size_t size = 0;

  constexpr void add(std::string_view part) {
    for (const char c : part) text[size++] = c;
  }
  constexpr void add(std::uint32_t number) {
    if (number >= 10) add(number / 10);
    text[size++] = static_cast<char>('0' + number % 10);
  }
};
constexpr FaultBits kFaultBits = [] {
  FaultBits bits;
  bits.add("bits: ");
  for (const FaultInfo& fault : kFaults) {
    if (fault.bit > 1) bits.add("; ");
    bits.add(std::uint32_t{fault.bit});
    bits.add(" ");
    bits.add(fault.text);
  }
  return bits;
}();

constexpr StoredField kCheck{"check", kU64, 1, "", "XXH3-64 of the row's bytes before it"};

constexpr std::array<StoredField, 10> kRoot{{
    {"format", kText, 1, "", "\"sulcus-recording\""},
    {"version", kU32, 1, "", "of this layout, 2"},
    {"scene", kText, 1, "", "the TOML as run, with every --set in it"},
    {"scene_sha256", kText, 1, "", "of that, hexadecimal"},
    {"workpiece_hash", kU64, 1, "", "of the workpiece at the start"},
    {"build", kText, 1, "", "the program that wrote it"},
    {"rate_hz", kF64, 1, "Hz", "ticks a second"},
    {"parent", kText, 1, "", "only where it goes on from another: from which, and where"},
    {"repaired", kText, 1, "", "only of a repaired copy: what was missing"},
    {"header_check", kU64, 1, "", "XXH3-64 over the others"},
}};

constexpr std::array<StoredField, 19> kTicks{{
    {"tick", kU64, 1, "", "its number, the first of a run being 0"},
    {"time_s", kF64, 1, "s", "of the simulation"},
    {"device_position_m", kF64, 3, "m", "of the burr's tip as the device has it, world"},
    {"device_orientation", kF64, 4, "", "w, x, y, z; world from tool"},
    {"tool_position_m", kF64, 3, "m", "of the tip where the coupling holds it, world"},
    {"tool_orientation", kF64, 4, "", "w, x, y, z; world from tool"},
    {"force_N", kF64, 3, "N", "sent to the device, world"},
    {"torque_Nm", kF64, 3, "N m", "sent to the device, about the burr's reference point, world"},
    {"contact_force_N", kF64, 3, "N", "of the contact alone"},
    {"contact_torque_Nm", kF64, 3, "N m", "of the contact alone, about the same point"},
    {"contacts", kU32, 1, "", "voxels in contact"},
    {"tested", kU32, 1, "", "voxels that were looked at"},
    {"leaves", kU32, 1, "", "leaves of the octree that the burr reached"},
    {"removed", kU32, 1, "", "voxels cut of the workpiece"},
    {"step_us", kF32, 1, "us", "compute time; no part of the result"},
    {"late_us", kF32, 1, "us", "how late it woke; no part of the result"},
    {"faults", kU64, 1, "", {kFaultBits.text.data(), kFaultBits.size}},
    {"edits_end", kU64, 1, "", "rows of /edits up to and with this tick"},
    kCheck,
}};

constexpr std::array<StoredField, 5> kEdits{{
    {"tick", kU64, 1, "", "in which the voxel went"},
    {"body", kU16, 1, "", "0 the workpiece, 1 the first of /bodies, ..."},
    {"voxel", kU32, 1, "", "x + y nx + z nx ny, of its grid of nx x ny x nz cells"},
    {"cause", kU8, 1, "", "0 cut, 1 came loose with a piece (2, undone: written by none)"},
    {"check", kU32, 1, "", "low half of XXH3-64 of the row's bytes before it"},
}};

constexpr std::array<StoredField, 5> kFills{{
    {"tick", kU64, 1, "", "in which the voxel's level fell"},
    {"body", kU16, 1, "", "as in /edits"},
    {"voxel", kU32, 1, "", "as in /edits"},
    {"level", kU8, 1, "", "how much of it is filled from then on, in parts of 255: 1 to 254"},
    {"check", kU32, 1, "", "low half of XXH3-64 of the row's bytes before it"},
}};

constexpr std::array<StoredField, 3> kFillEnds{{
    {"tick", kU64, 1, "", "as in /ticks"},
    {"fills_end", kU64, 1, "", "rows of /fills up to and with this tick"},
    kCheck,
}};

constexpr std::array<StoredField, 6> kCutting{{
    {"tick", kU64, 1, "", "as in /ticks"},
    {"tangential_force_N", kF64, 3, "N", "the part of the contact force along the surface, world"},
    {"tangential_torque_Nm", kF64, 3, "N m", "of it about the burr's reference point"},
    {"spindle_rad_per_s", kF64, 1, "rad/s", "about the axis from tip to shank"},
    {"work_J", kF64, 1, "J", "of the tangential force, up to and with this tick"},
    kCheck,
}};

constexpr std::array<StoredField, 8> kPort{{
    {"tick", kU64, 1, "", "as in /ticks"},
    {"asked_force_N", kF64, 3, "N", "of the coupling, else of the contact, before any limit"},
    {"asked_torque_Nm", kF64, 3, "N m", "the same"},
    {"absorbed_J", kF64, 1, "J", "by the simulation since the contact began; below 0: given out"},
    {"given_out_J", kF64, 1, "J", "by all contacts up to now"},
    {"dissipated_J", kF64, 1, "J", "by the passivity controller"},
    {"evaluations", kU64, 1, "", "of the contact in this tick"},
    kCheck,
}};

constexpr std::array<StoredField, 5> kPieces{{
    {"piece", kU64, 1, "", "from 0 on"},
    {"tick", kU64, 1, "", "in which its last voxel left the workpiece"},
    {"first_loose_edit", kU64, 1, "", "number of its first among the rows of /edits of cause 1"},
    {"voxels", kU64, 1, "", "which follow one another there"},
    kCheck,
}};

constexpr std::array<StoredField, 5> kPiecePoses{{
    {"tick", kU64, 1, "", "every tenth while it moves, the last at rest"},
    {"piece", kU64, 1, "", "as in /pieces"},
    {"position_m", kF64, 3, "m", "of what was the origin; world now from world where it was"},
    {"orientation", kF64, 4, "", "w, x, y, z; the same"},
    kCheck,
}};

constexpr std::array<StoredField, 3> kTakenAnswers{{
    {"asked", kU64, 1, "", "the tick after which pieces were looked for"},
    {"taken", kU64, 1, "", "the tick in which what was found was taken out"},
    kCheck,
}};

constexpr std::array<StoredField, 3> kPedal{{
    {"tick", kU64, 1, "", "from it on"},
    {"share", kF64, 1, "", "of the burr's speed that is asked for, 0 to 1"},
    kCheck,
}};

constexpr std::array<StoredField, 4> kStateHashes{{
    {"tick", kU64, 1, "", "right after it"},
    {"volume", kU64, 1, "", "hash of the voxels"},
    {"state", kU64, 1, "", "hash of all else that a later tick depends on"},
    kCheck,
}};

constexpr std::array<StoredField, 1> kKeyframes{{{"", kU8, 1, "", "bytes"}}};

constexpr std::array<StoredField, 5> kKeyframeIndex{{
    {"tick", kU64, 1, "", "right after it"},
    {"offset", kU64, 1, "", "of its first byte in /keyframes"},
    {"bytes", kU64, 1, "", "how many"},
    {"content", kU64, 1, "", "XXH3-64 of them"},
    kCheck,
}};

constexpr std::array<StoredField, 4> kEnd{{
    {"ticks", kU64, 1, "", "rows of /ticks"},
    {"edits", kU64, 1, "", "rows of /edits"},
    {"state_hashes", kU64, 1, "", "rows of /state_hashes"},
    kCheck,
}};

constexpr std::array<StoredField, 1> kSummary{{{"", kU8, 1, "", "UTF-8"}}};

constexpr std::array<StoredField, 3> kSummaryCheck{{
    {"bytes", kU64, 1, "", "of /summary"},
    {"content", kU64, 1, "", "XXH3-64 of them"},
    kCheck,
}};

constexpr std::array<StoredField, 13> kEarlier{{
    {"recording", kText, 1, "", "the one that was gone on from, as it was named"},
    {"scene_sha256", kText, 1, "", "of its scene"},
    {"ticks", kU64, 1, "", "rows since the first tick of all"},
    {"ticks_in_contact", kU64, 1, "", "of them"},
    {"peak_force_N", kF64, 1, "N", "while in contact"},
    {"force_in_contact_sum_N", kF64, 1, "N", "of the magnitudes while in contact"},
    {"limited_ticks", kU64, 1, "", "in which the device was not sent what was asked for"},
    {"buzz_ticks", kU64, 1, "", "in which the force buzzed"},
    {"silent_ticks", kU64, 1, "", "in which the device did not answer"},
    {"jumped_ticks", kU64, 1, "", "in which its pose jumped"},
    {"long_step_ticks", kU64, 1, "", "in which its step was too long to be followed"},
    {"inside_ticks", kU64, 1, "", "in which the burr was inside of a solid"},
    {"check", kU64, 1, "", "XXH3-64 over the others"},
}};

constexpr std::array<StoredField, 4> kSolid{{
    {"cells", kU32, 3, "", "of the grid along x, y, z: nx, ny, nz"},
    {"voxel_m", kF64, 1, "m", "edge of a voxel; the grid's centre is the origin of its space"},
    {"clipped", kU8, 1, "", "1: the solid reached beyond the grid"},
    {"check", kU64, 1, "", "XXH3-64 over all of it"},
}};
constexpr std::array<StoredField, 1> kLeaves{
    {{"", kU32, 1, "", "x + y nx/8 + z nx/8 ny/8, of the grid's leaves of 8 x 8 x 8 voxels"}}};
constexpr std::array<StoredField, 1> kWords{
    {{"", kU64, 8, "", "a slice of its voxels each, along z; bit x + 8 y: solid"}}};
constexpr std::array<StoredField, 1> kLeafLabels{
    {{"", kU8, 1, "", "tissue, by its place in the scene, 0 the first"}}};
constexpr std::array<StoredField, 1> kMixed{{{"", kU32, 1, "", "place in leaves, from 0 on"}}};
constexpr std::array<StoredField, 1> kMixedLabels{
    {{"", kU8, 512, "", "tissues of its voxels, x + 8 y + 64 z"}}};

constexpr std::array<StoredField, 1> kLevelled{{{"", kU32, 1, "", "place in leaves, from 0 on"}}};
constexpr std::array<StoredField, 1> kLevels{
    {{"", kU8, 512, "", "of its voxels, x + 8 y + 64 z, in parts of 255: 0 empty, 255 full"}}};

constexpr std::array<StoredField, 6> kInput{{
    {"file_from_scene", kF64, 12, "", "three rows of four: turn, and way in m"},
    {"sizes", kF64, 3, "", "of a volume, voxels; 0 for a mesh"},
    {"spacing_m", kF64, 3, "m", "of a volume's voxels"},
    {"origin_m", kF64, 3, "m", "centre of a volume's first voxel"},
    {"direction", kF64, 9, "", "three rows; the columns are a volume's axes"},
    {"check", kU64, 1, "", "XXH3-64 over all of it"},
}};
constexpr std::array<StoredField, 1> kBurr{{{"check", kU64, 1, "", "XXH3-64 over all of it"}}};
constexpr std::array<StoredField, 1> kPositions{{{"", kF32, 3, "m", "x, y, z; tool space"}}};
constexpr std::array<StoredField, 1> kTriangles{
    {{"", kU32, 3, "", "positions, from 0 on, counter-clockwise from outside"}}};

using Text = std::string_view;
using Fields = std::span<const StoredField>;

constexpr StoredPart group(Text path, Text when, Text what, Fields attributes) {
  return {path, StoredKind::kGroup, when, what, attributes, {}};
}
constexpr StoredPart like(Text path, Text other, Text when, Text what) {
  return {path, StoredKind::kGroup, when, what, {}, other};
}
constexpr StoredPart rows(Text path, Text when, Text what, Fields columns) {
  return {path, StoredKind::kRows, when, what, columns, {}};
}
constexpr StoredPart one_row(Text path, Text when, Text what, Fields columns) {
  return {path, StoredKind::kRow, when, what, columns, {}};
}
constexpr StoredPart array(Text path, Text when, Text what, Fields values) {
  return {path, StoredKind::kArray, when, what, values, {}};
}

// What these parts come with.
constexpr Text kWithPieces = "with [loose_pieces]", kWithTissues = "with several tissues",
               kWithBodies = "with [[body]]", kWhereItGoesOn = "where it goes on from another",
               kWithFills = "with surface = \"fractions\"";

constexpr std::array kLayout{
    group("/", "", "what the recording is", kRoot),
    rows("/ticks", "", "one row for each tick", kTicks),
    rows("/edits", "", "every voxel that went, in order", kEdits),
    rows("/fills", kWithFills, "every voxel that is less filled than it was, in order", kFills),
    rows("/fill_ends", kWithFills, "one row for each of /ticks", kFillEnds),
    rows("/cutting", "with [cutting]", "one row for each of /ticks", kCutting),
    rows("/port", "with [device] or [coupling]", "one row for each of /ticks", kPort),
    rows("/pieces", kWithPieces, "what came loose and left", kPieces),
    rows("/piece_poses", kWithPieces, "how they moved", kPiecePoses),
    rows("/taken_answers", kWithPieces, "for a replay", kTakenAnswers),
    rows("/pedal", "with a pedal or a switch", "each change of it; before the first: 1", kPedal),
    rows("/state_hashes", "", "from which a replay is verified", kStateHashes),
    rows("/keyframe_index", "", "states to go back to", kKeyframeIndex),
    array("/keyframes", "", "those states, one after another; for this program", kKeyframes),
    one_row("/end", "", "what it holds; all 0 where it was not closed", kEnd),
    array("/summary", "", "summary.json of the run; none where it was not ended", kSummary),
    one_row("/summary_check", "", "of that; all 0 where there is none", kSummaryCheck),
    group("/workpiece", "", "the solid at the start", kSolid),
    array("/workpiece/leaves", "", "those with a solid voxel, rising", kLeaves),
    array("/workpiece/words", "", "for each of leaves", kWords),
    array("/workpiece/leaf_labels", kWithTissues, "for each of leaves", kLeafLabels),
    array("/workpiece/mixed", kWithTissues, "those of several tissues, rising", kMixed),
    array("/workpiece/mixed_labels", kWithTissues, "for each of mixed", kMixedLabels),
    array("/workpiece/levelled", kWithFills, "those with a voxel that is not full, rising",
          kLevelled),
    array("/workpiece/levels", kWithFills, "for each of levelled", kLevels),
    group("/bodies", kWithBodies, "the solids beside it", {}),
    like("/bodies/0", "/workpiece", kWithBodies, "and so on, in their order"),
    like("/goal", "/workpiece", "with a file in [goal]",
         "what that holds, on the workpiece's grid"),
    group("/earlier", kWhereItGoesOn, "what came before, for the marks of the whole", kEarlier),
    rows("/earlier/edits", kWhereItGoesOn, "every voxel that had gone", kEdits),
    rows("/earlier/fills", kWithFills, "every voxel that had been less filled than before", kFills),
    like("/earlier/workpiece", "/workpiece", kWhereItGoesOn,
         "the leaves that these are of, as they were before the first tick of all"),
    group("/input", "with a file in [workpiece]",
          "where that file lies: its space, and of a volume its voxels", kInput),
    group("/burr", "with a file in [burr]", "its surface", kBurr),
    array("/burr/positions", "", "of its vertices", kPositions),
    array("/burr/triangles", "", "of it", kTriangles),
};

}  // namespace

std::span<const StoredPart> recording_layout() noexcept { return kLayout; }

const StoredPart* find_stored_part(std::string_view path) noexcept {
  for (const StoredPart& part : kLayout) {
    if (part.path == path) return &part;
  }
  return nullptr;
}

std::size_t bytes_of(StoredType type) noexcept {
  constexpr std::array<std::size_t, 7> kBytes{1, 2, 4, 8, 4, 8, 1};
  return kBytes[static_cast<std::size_t>(type)];
}

}  // namespace sulcus
