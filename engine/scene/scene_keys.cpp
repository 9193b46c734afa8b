#include "engine/scene/scene_keys.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/normals/height_map.hpp"
#include "engine/scene/device_presets.hpp"
#include "engine/scene/handpiece_presets.hpp"
#include "engine/scene/measures.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

namespace {

constexpr Range kAnyLength_mm{-1e3, 1e3};
constexpr Range kSize_mm{0.01, 1e3};
constexpr Range kAngle_deg{-360, 360};
constexpr Range kGrey{-1e9, 1e9};
constexpr Range kLabel{1, 65535};
constexpr Range kForce_N{0, 1e3};
constexpr Range kTorque_mNm{0, 1e5};
constexpr Range kWarmth_C{0, 100};

using Text = std::string_view;

constexpr SceneKey number(Text key, Range range, Text default_toml, Text what) {
  return {key, KeyKind::kNumber, range, 1, {}, default_toml, what, {}};
}
constexpr SceneKey whole(Text key, Range range, Text default_toml, Text what) {
  return {key, KeyKind::kWhole, range, 1, {}, default_toml, what, {}};
}
constexpr SceneKey numbers(Text key, std::size_t count, Range range, Text default_toml, Text what) {
  return {key, KeyKind::kNumbers, range, count, {}, default_toml, what, {}};
}
constexpr SceneKey rows(Text key, std::size_t count, Text fields, Range range, Text what) {
  return {key, KeyKind::kRows, range, count, {}, {}, what, fields};
}
constexpr SceneKey direction(Text key, Text default_toml, Text what) {
  return {key, KeyKind::kDirection, {-1e6, 1e6}, 3, {}, default_toml, what, {}};
}
constexpr SceneKey boolean(Text key, Text default_toml, Text what) {
  return {key, KeyKind::kBoolean, {}, 1, {}, default_toml, what, {}};
}
constexpr SceneKey text(Text key, Text default_toml, Text what) {
  return {key, KeyKind::kText, {}, 1, {}, default_toml, what, {}};
}
constexpr SceneKey choice(Text key, std::span<const Text> words, Text default_toml, Text what) {
  return {key, KeyKind::kChoice, {}, 1, words, default_toml, what, {}};
}
constexpr SceneKey path(Text key, Text what) {
  return {key, KeyKind::kPath, {}, 1, {}, {}, what, {}};
}

constexpr SceneKey limit(const MeasureName& measure) {
  return {measure.name, KeyKind::kLimit, {-1e6, 1e6}, 1, {}, {}, measure.what, {}};
}
constexpr SceneKey weight(const MeasureName& measure) {
  return {measure.name, KeyKind::kNumber, {0, 1000}, 1, {}, {}, "in the mark (1)", {}};
}

constexpr std::array<Text, 6> kShapes{"molar", "sphere", "box", "plate", "torus", "groove"};
constexpr std::array<Text, 5> kBurrShapes{"round", "pear", "fissure", "inverted_cone", "flame"};
constexpr std::array<Text, 2> kGoalShapes{"box", "cylinder"};
constexpr SceneKey kUnit = choice("unit", kMeshUnitNames, "\"mm\"",
                                  "of the numbers in a mesh file (sulcus inspect guesses it)");
constexpr std::array<Text, 2> kModels{"simulated", "played_back"};

constexpr std::array kTop{
    text("title", "(the file's name)", "what it is called in pictures and summaries"),
};

constexpr std::array kWorkpiece{
    choice("shape", kShapes, "", "a built-in shape; either this or file"),
    path("file",
         "a volume (.nrrd .mha .mhd .nii .tif, a folder of DICOM, TIFF or PNG slices) or a mesh "
         "(.stl .obj .ply); relative to the scene file, or by --set to the current folder"),
    kUnit,
    number("solid_above", kGrey, "(a binary mask: above 0)", "grey value from which it is solid"),
    numbers("spacing_mm", 3, {1e-4, 100}, "(the file's)", "of a volume's voxels"),
    numbers(
        "box_mm", 6, {-1e5, 1e5}, "(all of the volume)",
        "x0, y0, z0, x1, y1, z1: only what of a volume lies in this box of the file's own space "
        "is taken (+x left, +y posterior, +z superior)"),
    path("labels", "a label volume on the lattice of file; with label"),
    whole("label", kLabel, "",
          "only voxels of this value are taken, of labels or else of file, then a label map"),
    choice("surface", kSurfaceNames, "\"binary\"",
           "what a voxel says: whether its centre is inside, or how much of it is filled"),
    number("voxel_mm", {1e-3, 10}, "0.0348", "edge of a voxel [Kim and Park 2019]"),
    numbers("cells", 3, {kLeafEdge, kMaxCellsPerAxis}, "[512, 512, 512]",
            "voxels along x, y, z, multiples of 8 [Kim and Park 2019]"),
    numbers("position_mm", 3, kAnyLength_mm, "[0, 0, 0]",
            "of the solid in the grid; of a [[body]], of its grid in the world"),
    numbers("rotation_deg", 3, kAngle_deg, "[0, 0, 0]", "about x, then y, then z"),
};
constexpr std::array kMolar{
    number("caries_radius_mm", {0, 2.5}, "0", "of a lesion under the central pit; 0: none"),
};
constexpr std::array kSphere{number("radius_mm", kSize_mm, "3", "of the ball")};
constexpr std::array kBox{numbers("size_mm", 3, kSize_mm, "[6, 6, 6]", "edges")};
constexpr std::array kPlate{
    number("thickness_mm", {1e-3, 1e3}, "1", "from face to face"),
    number("tilt_deg", {-90, 90}, "0", "about y"),
};
constexpr std::array kTorus{
    number("major_mm", kSize_mm, "3", "radius of the ring"),
    number("minor_mm", kSize_mm, "1", "radius of its tube, less than major_mm"),
};
constexpr std::array kGroove{
    number("angle_deg", {1, 179}, "90", "opening of the V, which runs along x"),
    number("depth_mm", kSize_mm, "1", "of the V in a flat face"),
};

constexpr std::array kTissue{
    text("name", "", "a name of one's own, or enamel, dentine, pulp or caries, which bring theirs"),
    number("above", kGrey, "", "grey value from which a voxel is of it; the highest that fits"),
    whole("label", kLabel, "", "value of its voxels in a label map (a file without solid_above)"),
    path(
        "file",
        "a mesh in the space of workpiece.file, itself a mesh and the surface of the first tissue: "
        "what lies within is of this one; a later table wins"),
    number("stiffness_N_per_mm", {1e-6, 1e6},
           "(that of its name, else 30; ten times that with [coupling])",
           "of the whole contact; of each voxel with scaling = \"none\" [assets/tissues.toml]"),
    number("specific_energy_J_per_mm3", {1e-9, 1e6}, "(that of its name, else 3.5)",
           "work of the tangential force per volume removed [assets/tissues.toml]"),
    numbers("colour", 3, {0, 1}, "(that of its name)", "linear red, green, blue"),
};

constexpr std::array kBody{
    text("name", "(body 1, body 2, ...)", "how summaries and messages call it"),
    boolean("cuttable", "false", "cut like the workpiece; with [cutting] only"),
    text("tissue", "(as it comes)", "all of it is of this [[tissue]] of the scene"),
};

constexpr std::array kSpareBurr{
    text("name", "(its shape and size)", "how a window calls it"),
};

constexpr std::array kBurr{
    choice("shape", kBurrShapes, "(\"round\", unless there is a file)", "of the head [ISO 6360]"),
    path("file", "a closed mesh, its axis along z from tip to shank"),
    kUnit,
    text("iso", "",
         "a number of ISO 6360, \"806 314 001 524 014\", or shape and size of it, \"001 014\": "
         "shape, diameter and some lengths (sulcus help burrs)"),
    number("diameter_mm", {0.3, 5.0}, "1.4", "the largest of the head"),
    number("length_mm", {0.2, 15.0}, "(the shape's ratio to the diameter; all of a file's)",
           "of the head, which cuts"),
    number("speed_rpm", {0, 500000}, "(the spindle preset's, else 7000)",
           "of the spindle, free of load [Kim and Park 2019]"),
    number("tangential_ratio", {0, 2}, "(0.3; under law = \"saturating\" 0.5)",
           "beta: tangential to normal force [Kim and Park 2019, eq. 7; haptics/README.md]"),
    numbers("field", 3, {8, 1024}, "[128, 512, 128]",
            "points of the distance field across, along, across, 2^27 in all, or \"auto\" [Kim and "
            "Park 2019]"),
    number("field_spacing_mm", {1e-4, 10}, "(as fine as the points allow)", "between them"),
    number("reference_mm", {0, 500}, "40", "torques are about the point this far up the axis"),
    choice("material", kBurrMaterialNames, "(iso's, else \"diamond\")",
           "of what cuts; under law = \"saturating\""),
    choice("grit", kGritNames, "(iso's, else \"medium\")",
           "of diamonds; under law = \"saturating\""),
    number("worn_mm", {0, 1e6}, "0",
           "that diamonds have cut since they were new; under law = \"saturating\""),
};

constexpr std::array kTrajectory{
    rows("points_mm", 3, "x, y, z", kAnyLength_mm, "of the burr's tip; this, file or recording"),
    path("file",
         "poses, .csv: columns t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz, or those of export --csv; world "
         "from tool, whose +y goes from tip to shank: upright, shank up, is 0.70710678, "
         "0.70710678, 0, 0"),
    path("recording", "an earlier recording, .h5, whose device's poses it is"),
    direction("axis", "[0, 0, 1]", "of the burr, from tip to shank"),
    number("speed_mm_per_s", {1e-3, 1e4}, "0.4", "from point to point"),
    number("hold_s", {0, 1e6}, "0", "time at the end"),
    number("load_N", {1e-3, 100}, "",
           "the tool moves on, at most 20 mm/s, until the contact holds this"),
    direction("load_direction", "(down, [0, 0, -1])", "where the load pushes; with load_N"),
};

constexpr std::array kHaptics{
    number("rate_hz", {10, 20000}, "1000", "ticks a second"),
    choice("normals", kNormalMethodNames, "\"ldm\"",
           "method of the contact normals; ldm_paper is Algorithm 1 [Kim and Park 2019]"),
    whole("neighbourhood", {1, kMaxNeighbourhood}, "(6; ldm and ldm_fast on a [coupling]: 10)",
          "NS: voxels to each side that a normal is found from [Kim and Park 2019]"),
    whole("trace", {1, kMaxTrace}, "(12; ldm_paper: 5)",
          "alpha: voxels that a map follows the surface up and down [Kim and Park 2019]"),
    number("normal_error_deg", {0, 90}, "",
           "instead of the three above: the cheapest normals whose mean error meets it"),
    choice("scaling", kScalingNames, "\"smooth\"",
           "of the stiffness by the contacts: count [Kim and Park 2019], mcneely [McNeely 1999]; "
           "potential: a force with an energy"),
    boolean("keep_normals", "true", "from tick to tick, under ldm and ldm_fast"),
    whole("refine_per_tick", {0, 1 << 20}, "16",
          "without effect: every normal is of the scene's method from the first contact on"),
    whole("max_contacts", {1, 1 << 20}, "65536", "capacity; beyond it the deepest are kept"),
};

constexpr std::array kDevice{
    choice(
        "model", kModels, "",
        "either this or plugin; played_back: no hand, its poses are those of trajectory.recording"),
    text("plugin", "", "name of a vendor's library for the device, never a path"),
    text("settings", "\"\"", "for the plug-in, in its own words"),
    numbers("position_mm", 3, kAnyLength_mm, "[0, 0, 0]", "where the plug-in's origin lies"),
    numbers("rotation_deg", 3, kAngle_deg, "[0, 0, 0]",
            "how its axes lie in the scene: about x, then y, then z"),
    number("scale", {0.01, 100}, "1",
           "the burr's way for the hand's; a spring is felt so many times as stiff"),
    boolean("recentre", "false", "the plug-in's first position comes to the trajectory's start"),
    number("stiffness_N_per_mm", {1e-3, 1e3}, "(the plug-in's)",
           "the hardest spring that the plug-in's device renders well"),
    choice("preset", kDevicePresetNames, "\"omni\"", "constants of a device [CHAI3D; ours]"),
    choice("hand", kHandPresetNames, "\"light\"", "how the handle is held"),
    number("hand_mass_g", {0, 1e4}, "(the hand's)", "of the hand on the handle"),
    number("hand_damping_N_s_per_m", {0, 1e3}, "(the hand's)", "between hand and trajectory"),
    number("hand_stiffness_N_per_m", {0, 1e5}, "(the hand's)", "between hand and trajectory"),
    number("hand_turning_damping_mNm_s_per_rad", kTorque_mNm, "(the hand's)", "of its direction"),
    number("hand_turning_stiffness_mNm_per_rad", kTorque_mNm, "(the hand's)", "of its direction"),
    number("push_N", kForce_N, "0", "that the hand pushes with besides, from the first contact"),
    number("push_ramp_s", {0, 1e3}, "0.2", "from the first force felt to all of the push"),
    direction("push_direction", "[0, 0, -1]", "where it pushes, world"),
    number("force_limit_N", {1e-3, 1e3}, "(the preset's)", "of what is sent to the device"),
    number("torque_limit_mNm", kTorque_mNm, "(the preset's)", "of what is sent; 0: renders none"),
    number("mass_g", {1, 1e4}, "(the preset's)", "of the handle"),
    number("damping_N_s_per_m", {0, 1e3}, "(the preset's)", "of the mechanism"),
    number("friction_N", kForce_N, "(the preset's)", "of the mechanism"),
    number("resolution_mm", {0, 10}, "(the preset's)", "of the encoders"),
    whole("delay_ticks", {0, 1}, "0", "between a force and its being held"),
    boolean("passivity_controller", "false",
            "takes energy that was given out back out of the motion [Hannaford and Ryu 2002]"),
    rows("late_s", 2, "time_s, by_s", {0, 1e6}, "ticks whose force comes late"),
    rows("silent_s", 2, "from_s, to_s", {0, 1e6},
         "when the device does not answer: bridged for 20 ms, then tool and spindle stand"),
    rows("jump_s_mm", 4, "time_s, x_mm, y_mm, z_mm", {-1e6, 1e6},
         "its pose is off by so much from then on"),
};

constexpr std::array kCoupling{
    number("stiffness_N_per_mm", {1e-3, 1e3}, "(the device's, else 0.7)",
           "of the spring between device and tool"),
    number("turning_stiffness_Nm_per_rad", {1e-4, 1e3}, "0.2", "of the turning spring"),
    number("force_limit_N", {1e-3, 1e3}, "(the device's, else 3.3)", "it stretches no further"),
    number("torque_limit_mNm", {1e-3, 1e5}, "(the device's, else 100)", "it turns no further"),
    whole("evaluations", {1, 100}, "5", "of the contact, in a tick, at most"),
    whole("contacts_per_tick", {1, 1 << 24}, "20000", "voxels in all of them, at most"),
};

constexpr std::array kCutting{
    choice("law", kCuttingLawNames, "\"paper\"",
           "how much of the work removes: all of it, or less the harder and faster it is cut"),
    whole("max_cut_voxels", {1, 1 << 26}, "262144", "capacity for voxels that are part-cut"),
};
constexpr std::array kSpindle{
    choice("preset", kHandpiecePresetNames, "",
           "an air turbine, or an electric motor behind 1:5; sets burr.speed_rpm too"),
    number("stall_torque_mNm", {1e-3, 1e4}, "(the preset's, else 1)", "that stops it"),
    number("inertia_g_mm2", {1e-3, 1e6}, "(the preset's, else 5)", "of rotor and burr"),
    number("droop", {1e-3, 1}, "(the preset's, else 1)",
           "share of the free speed that it loses by the time it gives its largest torque"),
    number("power_W", {1e-3, 1e4}, "(the preset's, else what torque and speed give)",
           "that it gives at most"),
};
constexpr std::array kLoosePieces{
    number("smallest_mm3", {0, 1e3}, "0.01", "smaller ones vanish"),
    number("friction", {0, 10}, "0.4", "coefficient, among them and with the tooth"),
    number("floor_mm", kAnyLength_mm, "(the bottom of the grid)", "height of the floor"),
};
constexpr std::array kGoal{
    choice("shape", kGoalShapes, "", "of the cavity; either this or file"),
    path("file", "a mesh or a volume of the cavity"),
    kUnit,
    number("solid_above", kGrey, "(a binary mask: above 0)", "with file: what is of the cavity"),
    numbers("size_mm", 3, kSize_mm, "", "of a box, half way up"),
    number("diameter_mm", kSize_mm, "", "of a cylinder, half way up"),
    number("depth_mm", kSize_mm, "", "of a cylinder, along its z"),
    number("taper_deg", {-45, 45}, "0", "by which each wall leans outward going up"),
    numbers("position_mm", 3, kAnyLength_mm, "[0, 0, 0]", "of its centre"),
    numbers("rotation_deg", 3, kAngle_deg, "[0, 0, 0]", "about x, then y, then z"),
    number("pulp_distance_mm", kSize_mm, "",
           "of tooth that is to stay over the pulp: less is warned of; also without a cavity"),
};
constexpr std::array kHeat{
    number("cell_mm", {0.1, 1}, "0.2", "edge of a cell with one temperature, to a whole voxel"),
    number("start_C", kWarmth_C, "37", "of the tooth, and always of gum and bone [Lin 2014]"),
    number("tooth_share", {0, 1}, "0.038",
           "of the work of cutting: what of it heats the tooth; fitted to 6.8 K, dry [Farah 2019]"),
    number("water_ml_min", {0, 500}, "0", "on the tooth while the burr turns; 0: dry"),
    number("water_C", kWarmth_C, "23", "of the water [Farah 2019]"),
    choice("spray", kSprayNames, "\"jet\"", "how the water comes"),
    number("air_C", kWarmth_C, "25", "where there is no water [Lin 2014]"),
    number("gum_mm", kAnyLength_mm, "(nowhere)",
           "height, z, below which the tooth stands in gum and bone"),
};
constexpr std::array kRender{
    numbers("size", 2, {16, 8192}, "[1280, 720]", "width and height, pixels"),
    number("fps", {0.01, 1000}, "30", "pictures a second of simulated time"),
    choice("camera", kCameraNames, "\"review\"", "where it is seen from"),
    boolean("hud", "true", "figures over the picture"),
    boolean("arrows", "false", "force and torque at the burr"),
    text("section", "", "cut open across an axis, \"y=0\" (mm)"),
};
constexpr std::array kRecord{
    number("queue_s", {0.1, 600.0}, "10",
           "of a stalled disk that is waited for, before rows are left out"),
};
// Device names of messages: at most 20 characters, "" leaves a message out.
constexpr std::array kStream{
    text("address", "\"127.0.0.1\"", "IPv4, where it waits for clients; \"0.0.0.0\": everywhere"),
    whole("port", {1, 65535}, "18944", "TCP"),
    number("rate_hz", {0.01, 1e5}, "50", "samples a second of the run's time"),
    text("tick", "\"Tick\"", "name of the SENSOR of tick, contacts, fault bits; \"\": not sent"),
    text("tool", "\"ToolToScene\"", "name of the burr's TRANSFORM; so with all names below"),
    text("hand", "\"HandToScene\"", "the device's TRANSFORM, with [device] or [coupling]"),
    text("force", "\"Force\"", "SENSOR, N: on the hand, of the contact"),
    text("torque", "\"Torque\"", "SENSOR, N mm: on the hand, of the contact"),
    text("speed", "\"Speed\"", "SENSOR, rad/s: the spindle's, with [cutting]"),
    text("removed", "\"Removed\"", "SENSOR, m3: in all, then by tissue, with [cutting]"),
    text("state", "\"State\"", "STATUS: running, paused, fault, over"),
    text("tooth", "\"Tooth\"", "POLYDATA and IMAGE, of who asks"),
};

constexpr std::array<Text, 4> kAssessmentPresets{"class_one", "class_two", "access", "crown"};

/// Its own keys, and a limit for each measure.
constexpr auto kAssessment = [] {
  constexpr std::array kOwn{
      choice("preset", kAssessmentPresets, "", "limits of a school; keys beside it go before them"),
      choice("kind", kAssessedKindNames, "(of the preset, else \"cavity\")", "what was prepared"),
      direction("insertion", "[0, 0, 1]", "path of insertion, out of the tooth"),
      direction("mesial", "[1, 0, 0]", "out of the tooth to its mesial side"),
      direction("buccal", "[0, -1, 0]", "out of the tooth to its buccal side"),
      number("tolerance_mm", {1e-3, 10}, "0.3", "of a comparison with a goal [Dai 2024]"),
      number(
          "voxel_mm", {1e-3, 1}, "0.02",
          "between the rays that surfaces are measured on; at least as far as 2 million of them")};
  std::array<SceneKey, kOwn.size() + kMeasures.size()> keys{};
  std::ranges::copy(kOwn, keys.begin());
  for (std::size_t i = 0; i < kMeasures.size(); ++i) keys[kOwn.size() + i] = limit(kMeasures[i]);
  return keys;
}();
constexpr auto kWeights = [] {
  std::array<SceneKey, kMeasures.size()> keys{};
  for (std::size_t i = 0; i < kMeasures.size(); ++i) keys[i] = weight(kMeasures[i]);
  return keys;
}();

constexpr std::array<SceneTableKeys, 26> kTables{{
    {"", false, "at the top of the file", kTop, {}},
    {"workpiece", false, "what is probed and cut; must be there", kWorkpiece, {}},
    {"workpiece.molar", false, "with shape = \"molar\"; its crown points to +z", kMolar, {}},
    {"workpiece.sphere", false, "with shape = \"sphere\"", kSphere, {}},
    {"workpiece.box", false, "with shape = \"box\"", kBox, {}},
    {"workpiece.plate", false, "with shape = \"plate\", endless", kPlate, {}},
    {"workpiece.torus", false, "with shape = \"torus\"", kTorus, {}},
    {"workpiece.groove", false, "with shape = \"groove\"", kGroove, {}},
    {"tissue",
     true,
     "what it is made of, or tissue = [\"enamel\", ...] alone; (enamel)",
     kTissue,
     {}},
    {"burr", false, "the tool", kBurr, {}},
    {"spare_burr", true,
     "a burr to change to, 15 at most; what it does not say of speed, field and contact is "
     "[burr]'s",
     kSpareBurr, "burr"},
    {"trajectory", false, "where it goes; must be there", kTrajectory, {}},
    {"haptics", false, "how the contact is computed", kHaptics, {}},
    {"body", true, "a solid beside the workpiece, 15 at most", kBody, "workpiece"},
    {"device", false, "a simulated device and a hand on it, or a plug-in", kDevice, {}},
    {"coupling", false, "the tool hangs on the device by springs", kCoupling, {}},
    {"cutting", false, "voxels go when their energy is spent", kCutting, {}},
    {"spindle", false, "its speed sags under load; with [cutting]", kSpindle, {}},
    {"loose_pieces", false, "what is cut off falls; with [cutting]", kLoosePieces, {}},
    {"goal", false, "the cavity to be cut, the pulp to be spared; with [cutting]", kGoal, {}},
    {"assessment", false, "what sulcus assess marks it by; with [cutting]", kAssessment, {}},
    {"assessment.weights", false, "of the limits that are not met", kWeights, {}},
    {"heat", false, "how warm the tooth becomes; with [cutting]", kHeat, {}},
    {"render", false, "pictures are drawn", kRender, {}},
    {"record", false, "recording.h5 is written", kRecord, {}},
    {"stream", false, "sent by OpenIGTLink while it runs", kStream, {}},
}};

// Longest first: the first that fits is taken.
constexpr std::array<std::pair<Text, Text>, 29> kUnits{{{"_mNm_s_per_rad", "mN m s/rad"},
                                                        {"_mNm_per_rad", "mN m/rad"},
                                                        {"_Nm_per_rad", "N m/rad"},
                                                        {"_J_per_mm3", "J/mm3"},
                                                        {"_mm3_per_s", "mm3/s"},
                                                        {"_N_s_per_m", "N s/m"},
                                                        {"_mm_per_s", "mm/s"},
                                                        {"_N_per_mm", "N/mm"},
                                                        {"_N_per_m", "N/m"},
                                                        {"_ml_min", "ml/min"},
                                                        {"_per_s", "/s"},
                                                        {"_g_mm2", "g mm2"},
                                                        {"_s_mm", "s, mm"},
                                                        {"_mm3", "mm3"},
                                                        {"_mm2", "mm2"},
                                                        {"_um", "um"},
                                                        {"_mNm", "mN m"},
                                                        {"_rpm", "rpm"},
                                                        {"_deg", "deg"},
                                                        {"_mm", "mm"},
                                                        {"_hz", "Hz"},
                                                        {"_kg", "kg"},
                                                        {"_Nm", "N m"},
                                                        {"_C", "C"},
                                                        {"_N", "N"},
                                                        {"_W", "W"},
                                                        {"_g", "g"},
                                                        {"_m", "m"},
                                                        {"_s", "s"}}};

/// The same below a table that another's stand in for.
const SceneTableKeys* table_behind(Text name) noexcept {
  const Text top = name.substr(0, name.find('.'));
  for (const SceneTableKeys& table : kTables) {
    if (table.name != top || table.inherits_from.empty()) continue;
    for (const SceneTableKeys& other : kTables) {
      const Text rest = name.substr(top.size());
      if (other.name.size() == table.inherits_from.size() + rest.size() &&
          other.name.starts_with(table.inherits_from) && other.name.ends_with(rest)) {
        return &other;
      }
    }
  }
  return nullptr;
}

}  // namespace

std::span<const MeasureName> measure_names() noexcept { return kMeasures; }

std::span<const SceneTableKeys> scene_tables() noexcept { return kTables; }

const SceneTableKeys* find_scene_table(Text name) noexcept {
  for (const SceneTableKeys& table : kTables) {
    if (table.name == name) return &table;
  }
  return table_behind(name);
}

const SceneKey* find_scene_key(Text table, Text key) noexcept {
  for (const SceneTableKeys* place : {find_scene_table(table), table_behind(table)}) {
    if (!place) continue;
    for (const SceneKey& row : place->keys) {
      if (row.key == key) return &row;
    }
  }
  return nullptr;
}

Text unit_of_key(Text key) noexcept {
  for (const auto& [ending, unit] : kUnits) {
    if (key.ends_with(ending)) return unit;
  }
  return {};
}

}  // namespace sulcus
