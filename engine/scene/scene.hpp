#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/input_limits.hpp"
#include "engine/core/pose.hpp"
#include "engine/normals/normal_settings.hpp"
#include "engine/scene/section.hpp"

namespace sulcus {

// What a scene file says, checked and in SI units. One struct per table; an optional table that a
// scene does not name is empty here, and nothing of it is modelled, allocated or timed.

enum class ShapeKind : std::uint8_t { kMolar, kSphere, kBox, kPlate, kTorus, kGroove };

/// What a voxel says of the surface: that its centre is inside, or how much of it is filled.
enum class SurfaceKind : std::uint8_t { kBinary, kFractions };
inline constexpr std::array<std::string_view, 2> kSurfaceNames{"binary", "fractions"};

/// Of the numbers in a mesh file, which does not say it itself.
enum class MeshUnit : std::uint8_t { kMicrometre, kMillimetre, kCentimetre, kMetre, kInch };
inline constexpr std::array<std::string_view, 5> kMeshUnitNames{"um", "mm", "cm", "m", "in"};
inline constexpr std::array<double, 5> kMeshUnits_m{1e-6, 1e-3, 1e-2, 1.0, 25.4e-3};
constexpr double metres_of(MeshUnit unit) { return kMeshUnits_m[static_cast<std::size_t>(unit)]; }

struct WorkpieceSettings {
  std::optional<ShapeKind> shape;  // exactly one of `shape` and `file` is set
  std::string file;                // volume or mesh, resolved against the scene's folder

  double sphere_radius_m = 3e-3;
  Eigen::Vector3d box_size_m{6e-3, 6e-3, 6e-3};
  double plate_thickness_m = 1e-3, plate_tilt = 0.0;  // tilt in rad about y
  double torus_major_m = 3e-3, torus_minor_m = 1e-3;
  double groove_angle = 1.5707963267948966, groove_depth_m = 1e-3;  // a V along x in a flat face
  double molar_caries_radius_m = 0.0;  // lesion under the central pit; 0: none

  std::optional<double> solid_above;            // grey value; none: binary mask
  std::optional<Eigen::Vector3d> spacing_m;     // instead of what a volume file says
  std::optional<Eigen::AlignedBox3d> box_file;  // m: of a volume only what lies in there is taken
  std::string labels;        // a label volume on the lattice of `file`; only with `label`
  std::optional<int> label;  // only voxels with this value are taken: of `labels`, else of `file`
  SurfaceKind surface = SurfaceKind::kBinary;
  double voxel_m = 34.8e-6;
  Eigen::Vector3i cells{512, 512, 512};
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // of the solid in the grid
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();    // rad, about x, then y, then z
  MeshUnit unit = MeshUnit::kMillimetre;  // of `file`, a mesh, and of the tissues' meshes
};

struct TissueSettings {
  std::string name;
  std::optional<double> above;    // grey value from which a voxel is of this tissue
  std::optional<int> label = {};  // value of its voxels in a label map; a scene has one of these
  std::string file = {};  // mesh: what of the workpiece lies within is of it; only beside a mesh
  double stiffness_N_per_m = 30e3;
  double specific_energy_J_per_m3 = 3.5e9;
  std::array<float, 3> colour{0.9f, 0.88f, 0.82f};  // linear RGB
};

enum class BurrShape : std::uint8_t { kRound, kPear, kFissure, kInvertedCone, kFlame, kFile };

enum class BurrMaterial : std::uint8_t { kDiamond, kCarbide };
inline constexpr std::array<std::string_view, 2> kBurrMaterialNames{"diamond", "carbide"};

/// Of the diamonds on a burr, as the colour of its ring says: red, none or blue, green, black.
enum class Grit : std::uint8_t { kFine, kMedium, kCoarse, kSuperCoarse };
inline constexpr std::array<std::string_view, 4> kGritNames{"fine", "medium", "coarse",
                                                            "super_coarse"};

struct BurrSettings {
  BurrShape shape = BurrShape::kRound;
  std::string file;
  double diameter_m = 1.4e-3;
  std::optional<double> length_m;  // of the head; none: the shape's own ratio to the diameter
  double speed_rad_per_s = 7000 * 0.10471975511965977;
  double tangential_ratio = 0.3;  // beta of [Kim and Park 2019, eq. 7]
  std::optional<Eigen::Vector3i> field_samples = Eigen::Vector3i{128, 512, 128};  // none: "auto"
  std::optional<double> field_spacing_m;  // none: as fine as the samples allow
  double reference_m = 40e-3;             // torque reference from the tip along the axis
  // What CuttingLaw::kSaturating asks for besides.
  BurrMaterial material = BurrMaterial::kDiamond;
  Grit grit = Grit::kMedium;              // of diamonds
  double worn_m = 0.0;                    // length that diamonds have cut since they were new
  MeshUnit unit = MeshUnit::kMillimetre;  // of `file`
};

/// A timed pose of the burr's tip.
struct TimedPose {
  double time_s = 0.0;
  Pose world_from_tool;
};

struct TrajectorySettings {
  std::vector<Eigen::Vector3d> points_m;  // exactly one of points, file and recording is set
  std::string file;
  std::string recording;          // whose device's poses it is
  Eigen::Vector3d axis{0, 0, 1};  // from tip to shank, unit
  double speed_m_per_s = 0.4e-3;
  double hold_s = 0.0;                       // time at the last point
  std::optional<double> load_N;              // the tool moves on until the contact holds it
  Eigen::Vector3d load_direction{0, 0, -1};  // unit, world
};

/// A body beside the workpiece, a neighbouring tooth or a jaw: a grid of its own that stays where
/// it is in the world. The burr feels it like the workpiece.
struct BodySettings {
  std::string name;
  WorkpieceSettings solid;            // in the middle of its grid, not turned there
  Pose world_from_grid;               // of the grid's centre
  bool cuttable = false;              // with [cutting]; else it holds whatever is done to it
  std::optional<std::size_t> tissue;  // all of it is of this one of the scene's; none: as it comes
};

/// What cutting separates from the tooth falls as a body of its own. Without it, it stays in the
/// air.
struct LoosePiecesSettings {
  double smallest_m3 = 1e-11;  // smaller ones vanish
  double friction = 0.4;
  std::optional<double> floor_m;  // height of the floor; none: the bottom of the grid
};

/// A motor whose torque is limited: its speed sags under load. Without it the spindle turns at
/// burr.speed_rpm whatever holds it.
struct SpindleSettings {
  double stall_torque_Nm = 1e-3;  // the largest
  double inertia_kg_m2 = 5e-9;    // of rotor and burr
  double droop = 1.0;             // share of the free speed over which the torque comes to that
  std::optional<double> power_W;  // the largest; none: what torque and speed make of it
};

enum class Scaling : std::uint8_t { kNone, kCount, kMcNeely, kSmooth, kPotential };
inline constexpr std::array<std::string_view, 5> kScalingNames{"none", "count", "mcneely", "smooth",
                                                               "potential"};

struct HapticsSettings : NormalSettings {
  double rate_hz = 1000.0;
  std::optional<double> normal_error_deg;  // asked for; the settings of normals are what meets it
  bool keep_normals = true;                // from tick to tick, under ldm and ldm_fast
  Scaling scaling = Scaling::kSmooth;
  int max_contacts = 65536;  // capacity; beyond it the deepest are kept
};

/// Springs between the device and the tool, at the middle of the burr's head: the tool goes where
/// they and the contact balance. Without them it follows the device exactly.
struct CouplingSettings {
  double stiffness_N_per_m = 700.0;  // none said: what the device's maker recommends
  double turning_stiffness_Nm_per_rad = 0.2;
  double force_limit_N = 3.3;  // they stretch no further; none said: the device's
  double torque_limit_Nm = 0.1;
  int evaluations = 5;            // of the contact, in a tick, at most
  int contacts_per_tick = 20000;  // of all evaluations; two of those there always are
};

/// The hand on a simulated device: a mass on a spring and a damper, whose other end goes along the
/// trajectory, and a force that it pushes with besides. It holds the handle in its direction by
/// `turning_*`, which matters only where the device can be turned.
struct HandSettings {
  double mass_kg = 0.0;
  double damping_N_s_per_m = 2.0;
  double stiffness_N_per_m = 100.0;
  double turning_damping_Nm_s_per_rad = 2e-3;
  double turning_stiffness_Nm_per_rad = 0.3;
  double push_N = 0.0;
  Eigen::Vector3d push_direction{0, 0, -1};  // unit, world
  double push_ramp_s = 0.2;                  // from the first force felt to all of the push
};

/// Faults of time and of the encoders that a simulated device is to have.
struct LateTick {
  std::uint64_t tick = 0;
  double by_s = 0.0;  // the force held before acts on for so much longer
};
struct DeviceSilence {
  std::uint64_t first = 0, last = 0;  // ticks in which it gives no pose
};
struct DeviceJump {
  std::uint64_t tick = 0;
  Eigen::Vector3d by_m = Eigen::Vector3d::Zero();  // its pose is off by so much from then on
};

/// Where a plug-in's device lies in the scene: what it gives is turned, scaled and moved, and what
/// it is sent is turned back. Forces are not scaled: with `scale` a spring in the scene is felt so
/// many times as stiff.
struct DevicePlacement {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // of its origin
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();    // rad, about x, then y, then z
  double scale = 1.0;                                    // the tip's way for the hand's
  bool recentre = false;  // its first position comes to the trajectory's start
};

/// A device that a vendor's library brings (haptics/device/sulcus_device.h), by its name: never by
/// a path, so that what a scene says runs nothing but what the user has put there. Its limits are
/// the smaller ones of the scene's and the plug-in's, its resolution the larger one; a scene as run
/// and recorded says them.
struct PluginSettings {
  std::string name;      // letters, digits, _ and -
  std::string settings;  // for the plug-in, in its own words
  // What the scene says; none: what the plug-in does.
  std::optional<double> force_limit_N, torque_limit_Nm, stiffness_N_per_m, resolution_m;
  DevicePlacement placement;
};

/// A haptic device and a hand, simulated: the handle, a mass with friction at the torque reference
/// of the burr, is driven by the hand and by the force of the last tick, and read at the encoders'
/// resolution. Without an inertia it cannot be turned: the hand holds it in the trajectory's
/// direction, and torques are not rendered. Of a plug-in there are the limits, the resolution and
/// the delay.
struct DeviceSettings {
  std::optional<PluginSettings> plugin;  // none: simulated
  bool played_back = false;              // nor simulated: its poses are those of a recording
  double force_limit_N = 3.3;
  double torque_limit_Nm = 0.0;      // 0: renders none
  double stiffness_N_per_m = 700.0;  // the largest that its maker recommends
  double mass_kg = 0.045;
  double damping_N_s_per_m = 0.1;
  double friction_N = 0.05;
  double resolution_m = 55e-6;
  double inertia_kg_m2 = 0.0;  // about the torque reference, any axis
  double turning_damping_Nm_s_per_rad = 0.0;
  double turning_friction_Nm = 0.0;
  double angle_resolution = 0.0;  // rad
  int delay_ticks = 0;            // between a force and its being held, 0 or 1
  HandSettings hand;
  std::vector<LateTick> late;
  std::vector<DeviceSilence> silences;
  std::vector<DeviceJump> jumps;
  bool passivity_controller = false;
};

/// How much of the tangential work removes: all of it [Kim and Park 2019, eq. 6], or a share that
/// falls with load and speed (haptics/cutting_law.hpp).
enum class CuttingLaw : std::uint8_t { kPaper, kSaturating };
inline constexpr std::array<std::string_view, 2> kCuttingLawNames{"paper", "saturating"};
/// burr.tangential_ratio under kSaturating: the middle of 0.40 to 0.60, tangential over normal
/// force of a dental handpiece on glass ceramic.
inline constexpr double kSaturatingTangentialRatio = 0.5;

struct CuttingSettings {
  int max_cut_voxels = 1 << 18;  // capacity of the part-cut state
  CuttingLaw law = CuttingLaw::kPaper;
};

enum class GoalShape : std::uint8_t { kBox, kCylinder, kFile };

/// A target cavity: what of it is tooth is to be removed, and nothing else.
struct GoalSettings {
  GoalShape shape = GoalShape::kBox;
  std::string file;                   // volume or mesh; the middle of its box comes to the position
  std::optional<double> solid_above;  // grey value of a volume; none: binary mask
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // box, half way up
  double diameter_m = 0.0, depth_m = 0.0;            // cylinder, half way up and along its z
  double taper = 0.0;  // rad, of each wall: how far it leans outward towards its own +z
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // of its centre
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();    // rad, about x, then y, then z
  MeshUnit unit = MeshUnit::kMillimetre;                 // of `file`, a mesh
};

/// How the water comes out of the handpiece: by itself, or blown apart by air.
enum class Spray : std::uint8_t { kJet, kMist };
inline constexpr std::array<std::string_view, 2> kSprayNames{"jet", "mist"};

/// How warm cutting makes the tooth: it is computed from the work and the edits of a run, and
/// influences nothing in it.
struct HeatSettings {
  double cell_m = 0.2e-3;       // edge of the cells with one temperature; voxels make them up
  double start_C = 37.0;        // of all of the tooth, and always of gum and bone
  double tooth_share = 0.038;   // of the work of cutting: what of it heats the tooth
  double water_m3_per_s = 0.0;  // on the tooth round the burr while it turns; 0: dry
  double water_C = 23.0;
  Spray spray = Spray::kJet;
  double air_C = 25.0;
  std::optional<double> gum_m;  // world z below which it stands in gum and bone; none: nowhere

  /// Voxels along the edge of a cell.
  int cell_voxels(double voxel_m) const {
    return std::max(1, static_cast<int>(std::lround(cell_m / voxel_m)));
  }
};

enum class Camera : std::uint8_t { kReview, kOcclusal, kBuccal, kMesial, kBurr };
inline constexpr std::array<std::string_view, 5> kCameraNames{"review", "occlusal", "buccal",
                                                              "mesial", "burr"};

struct RenderSettings {
  int width = 1280, height = 720;  // pixels
  double fps = 30.0;               // frames per second of simulated time
  Camera camera = Camera::kReview;
  bool hud = true;
  bool arrows = false;             // the force and the torque at the burr
  std::optional<Section> section;  // none: bodies are whole
};

struct RecordSettings {
  double queue_s = 10.0;  // of a stalled disk that is waited for, before rows are left out
};

/// A burr that the hand may change to: what it is called, and the scene's [burr] with it in place,
/// as of --set.
struct BurrChoice {
  std::string name, as_override;
};

/// What a run says of itself by OpenIGTLink, while it goes on, to who connects to it.
struct StreamSettings {
  std::string address = "127.0.0.1";  // IPv4, of this machine, at which it is waited for clients
  int port = 18944;                   // TCP
  double rate_hz = 50.0;              // samples a second of the run's time, at most one a tick
  // The device names of its messages; empty: that one is not sent.
  std::string tick = "Tick", tool = "ToolToScene", hand = "HandToScene", force = "Force",
              torque = "Torque", speed = "Speed", removed = "Removed", state = "State",
              tooth = "Tooth";
};

struct Scene {
  std::string title;
  WorkpieceSettings workpiece;
  std::vector<TissueSettings> tissues;  // at least one
  BurrSettings burr;
  std::vector<BurrChoice> burrs;  // with [[spare_burr]]: [burr], then those
  TrajectorySettings trajectory;
  HapticsSettings haptics;
  std::vector<BodySettings> bodies;      // besides the workpiece
  std::optional<DeviceSettings> device;  // none: the tool's trajectory is followed exactly
  std::optional<CouplingSettings> coupling;
  std::optional<CuttingSettings> cutting;
  std::optional<SpindleSettings> spindle;
  std::optional<LoosePiecesSettings> loose_pieces;
  std::optional<GoalSettings> goal;             // only beside [cutting]
  std::optional<double> least_pulp_distance_m;  // of what is cut, by [goal]: less is warned of
  std::optional<HeatSettings> heat;             // only beside [cutting]
  std::optional<RenderSettings> render;
  std::optional<RecordSettings> record;
  std::optional<StreamSettings> stream;

  std::string text;    // the TOML as run, with every --set in it: a recording carries this
  std::string file;    // where it came from, for messages
  InputLimits limits;  // of the files that it names; never said by a scene itself
};

}  // namespace sulcus
