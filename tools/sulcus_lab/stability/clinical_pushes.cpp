#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/scene/device_presets.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/pushes.hpp"

namespace sulcus::lab {

namespace {

using Eigen::Vector3d;

struct Head {
  const char* name;
  const char* toml;
  double radius_m, length_m;
  bool on_side;
};
constexpr std::array<Head, 7> kHeads{
    {{"round 1.0", "shape = 'round'\ndiameter_mm = 1.0", 0.5e-3, 1e-3, false},
     {"fissure on its side", "shape = 'fissure'\ndiameter_mm = 1.0\nlength_mm = 2.5", 0.5e-3,
      2.5e-3, true},
     {"round 0.5", "shape = 'round'\ndiameter_mm = 0.5", 0.25e-3, 0.5e-3, false},
     {"round 2.0", "shape = 'round'\ndiameter_mm = 2.0", 1e-3, 2e-3, false},
     {"fissure on its tip", "shape = 'fissure'\ndiameter_mm = 1.0\nlength_mm = 2.5", 0.5e-3, 2.5e-3,
      false},
     {"flame on its tip", "shape = 'flame'\ndiameter_mm = 1.0\nlength_mm = 2.5", 0.5e-3, 2.5e-3,
      false},
     {"flame on its side", "shape = 'flame'\ndiameter_mm = 1.0\nlength_mm = 2.5", 0.5e-3, 2.5e-3,
      true}}};

/// Where a burr is pressed: a scene's [workpiece] and what it describes, the point, and the
/// direction out of the solid.
struct Site {
  std::string name, workpiece;
  Vector3d point_m, out;
  bool is_hollow;  // around the point the solid falls off to where a burr comes to lie
  VoxelModel solid;
};

std::string push_text(const std::string& workpiece, const Head& head) {
  return "tissue = ['enamel']\n" + workpiece + "[burr]\n" + head.toml + "\nfield = 'auto'\n";
}

Site make_site(std::string name, std::string workpiece, const Vector3d& point_m,
               const Vector3d& out, bool is_hollow) {
  VoxelModel solid =
      build_workpiece(method_scene(ContactMethod::kCoupling, push_text(workpiece, kHeads[0])));
  return {std::move(name), std::move(workpiece), point_m, out, is_hollow, std::move(solid)};
}

/// The side of a plate of so many cells each way but along y. A burr that turns on its side walks:
/// pressed with 2 N it drags the light hand 6 mm along before that holds it. So far the face must
/// go, or it walks off.
Site face_at(int tilt_deg, int cells) {
  char text[200];
  std::snprintf(text, sizeof(text),
                "[workpiece]\nshape = 'plate'\ncells = [%d, 512, %d]\n"
                "plate.thickness_mm = 2.0\nplate.tilt_deg = %d\n",
                cells, cells, tilt_deg);
  const double tilt = tilt_deg * kDegree;
  const Vector3d out(std::sin(tilt), 0.0, std::cos(tilt));
  return make_site("face at " + std::to_string(tilt_deg) + " deg", text, 1e-3 * out, out, false);
}
constexpr int kFirstTilt_deg = 30;

std::vector<Site> sites(bool brief) {
  std::vector<Site> all;
  for (const int tilt_deg : {kFirstTilt_deg, 0, 15, 45}) {
    // It ends before the shank of a burr on its side, which is thicker than the head.
    constexpr int kCells = 128;
    all.push_back(face_at(tilt_deg, kCells));
    if (brief) break;
  }
  // Places on the way along the sulcus of scenes/cut_sulcus.toml, put in the middle of the grid.
  struct Pit {
    const char* name;
    double x_mm, y_mm, z_mm;
  };
  for (const Pit& pit :
       {Pit{"mesial fossa", 2.4, -0.2, 6.315}, Pit{"central pit", 0.40, 0.0, 5.649},
        Pit{"distal fossa", -2.4, -0.19, 5.862}}) {
    char text[200];
    std::snprintf(text, sizeof(text),
                  "[workpiece]\nshape = 'molar'\ncells = [192, 192, 192]\n"
                  "position_mm = [%g, %g, %g]\n",
                  -pit.x_mm, -pit.y_mm, -pit.z_mm);
    all.push_back(make_site(pit.name, text, Vector3d::Zero(), Vector3d::UnitZ(), true));
    if (brief) break;
  }
  return all;
}

/// Where a head comes down. In a hollow twice: straight onto where it comes to lie, and beside
/// that, from where it slides there.
struct Place {
  const Site* site;
  const Head* head;
  Vector3d start_m, axis;
  bool slides;

  std::string name() const {
    return std::string(head->name) + ", " + (slides ? "beside the " : "") + site->name;
  }
};

struct Task {
  const Place* place;
  Push push;
  PushResult result;
};

PushResult run(const Push& push, const Place& place) {
  constexpr double kReach_m = 3e-3;
  return run_push(push, push_text(place.site->workpiece, *place.head), place.start_m, kReach_m, {},
                  &place.site->solid);
}

Push push_at(const Place& place) {
  Push push;
  push.into = -place.site->out;
  push.axis = place.axis;
  return push;
}

/// Above where a head comes to lie that is pressed, let go and pressed again, as a hand finds it.
Vector3d above_rest(Place place) {
  Push push = push_at(place);
  push.hand = "firm";
  push.force_N = 2.0;
  constexpr int kPresses = 3;
  for (int press = 0; press < kPresses; ++press) {
    const PushResult pressed = run(push, place);
    if (!pressed.reached) break;
    const Vector3d moved = pressed.tip_m - place.start_m;
    place.start_m += moved - moved.dot(place.site->out) * place.site->out;
  }
  return place.start_m;
}

/// Over a site's point; on its side along the sulcus, its middle over the point.
Place place_over(const Site& site, const Head& head) {
  constexpr double kAbove_m = 0.8e-3;
  Place place{&site, &head, site.point_m + kAbove_m * site.out, site.out, false};
  if (head.on_side) {
    place.axis = (Vector3d::UnitX() - site.out.x() * site.out).normalized();
    place.start_m += head.radius_m * site.out - 0.5 * head.length_m * place.axis;
  }
  return place;
}

std::vector<Place> places_of(const std::vector<Site>& all_sites, std::size_t heads) {
  std::vector<Place> places;
  for (const Site& site : all_sites) {
    for (std::size_t h = 0; h < heads; ++h) {
      const Place place = places.emplace_back(place_over(site, kHeads[h]));
      if (!site.is_hollow) continue;
      places.push_back(place);
      places.back().slides = true;
    }
  }
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    Place& place = places[i];
    if (place.site->is_hollow && !place.slides) place.start_m = above_rest(place);
  });
  return places;
}

std::vector<Task> tasks_of(const std::vector<Place>& places, bool brief) {
  // A burr that cuts may hang on a slope for a second before it slips: the judged end is after.
  constexpr double kSlide_s = 1.0;
  std::vector<Task> tasks;
  std::vector<Push> loops;  // in brief the first
  for (const char* device : {"omni", "touch"}) {
    for (const std::string_view hand : kHandPresetNames) {
      for (const int delay : {1, 0}) {
        Push& push = loops.emplace_back();
        push.device = device;
        push.hand = hand;
        push.delay = delay;
      }
    }
  }
  if (brief) loops.resize(1);
  for (const Place& place : places) {
    for (const Push& loop : loops) {
      for (const double force_N : {0.5, 1.0, 2.0}) {
        for (const bool cutting : {false, true}) {
          Push push = loop;
          push.into = -place.site->out;
          push.axis = place.axis;
          push.force_N = force_N;
          push.cutting = cutting;
          if (cutting && place.slides) push.duration_s += kSlide_s;
          tasks.push_back({&place, push, {}});
        }
      }
    }
  }
  return tasks;
}

/// Contact was made, and what is pressed with is what is felt in the end: the tool has not gone
/// through, nor slid off. A quarter is for the encoders, whose quantum is 8 % of 0.5 N.
bool is_held(const Task& task) {
  const PushResult& r = task.result;
  return r.reached && !r.popped && r.contact_N > 0.75 * task.push.force_N;
}

/// Felt stiffness from one push to a harder one, over the coupling's.
double share_between(const Task& light, const Task& hard) {
  const double felt_N = hard.result.contact_N - light.result.contact_N;
  const double way_m = hard.result.in_device_m - light.result.in_device_m;
  return felt_N / way_m / device_preset(hard.push.device).stiffness_N_per_m;
}

/// What is told of a place's runs, with the spindle stopped or cutting.
struct Worst {
  double runs = 0.0, not_held = 0.0, unstable = 0.0, step_N = 0.0;
  double rms = 0.0, share = HUGE_VAL, whole_share = HUGE_VAL;
  const Task *of_rms = nullptr, *of_share = nullptr, *of_whole = nullptr;
};

Worst worst_of(const std::vector<Task>& tasks, const Place& place, bool cutting) {
  Worst worst;
  const Task* of_1_N = nullptr;  // with the same device, hand and delay
  for (const Task& task : tasks) {
    if (task.place != &place || task.push.cutting != cutting) continue;
    const PushResult& r = task.result;
    ++worst.runs;
    worst.not_held += !is_held(task);
    worst.unstable += !r.stable();
    worst.step_N = std::max(worst.step_N, r.step_N);
    if (!worst.of_rms || r.rms_m / r.resolution_m > worst.rms) {
      worst.rms = r.rms_m / r.resolution_m;
      worst.of_rms = &task;
    }
    if (task.push.force_N < 1.0) continue;
    const double whole = r.stiffness_N_per_m / device_preset(task.push.device).stiffness_N_per_m;
    if (whole < worst.whole_share) {
      worst.whole_share = whole;
      worst.of_whole = &task;
    }
    if (task.push.force_N == 1.0) {
      of_1_N = &task;
    } else if (const double between = share_between(*of_1_N, task); between < worst.share) {
      worst.share = between;
      worst.of_share = &task;
    }
  }
  return worst;
}

/// Says of a row in which run it was.
void say_run(StabilityRow& row, const Push& push) {
  row.device = push.device;
  row.hand = push.hand;
  row.delay = push.delay;
  row.push_N = push.force_N;
}

}  // namespace

/// What dentists press with, held: 0.5, 1 and 2 N on flat faces at four tilts and at three sites of
/// the molar's sulcus, with round burrs and with a fissure and a flame burr on their tips and
/// sides, devices omni and touch, all hands, delay 0 and 1, spindle stopped and cutting; rows for
/// each burr and place with the worst of its settings, which stands in the row. At the sites of the
/// sulcus a burr is pressed where it comes to lie, and also beside that, from where it slides
/// there. Felt stiffness from 1 N up, twice: from first contact on, which of the burrs that slide
/// first tells how far, and is only told, and from the push of 1 N to that of 2. In brief: one
/// device, hand and delay, two burrs, a face and a site.
void clinical_pushes(CaseTrial& trial) {
  constexpr double kLeastShare = 0.9;
  const std::vector<Site> all_sites = sites(trial.brief);
  const std::vector<Place> places = places_of(all_sites, trial.brief ? 2 : kHeads.size());
  std::vector<Task> tasks = tasks_of(places, trial.brief);
  tbb::parallel_for(std::size_t{0}, tasks.size(),
                    [&](std::size_t i) { tasks[i].result = run(tasks[i].push, *tasks[i].place); });
  for (const Place& place : places) {
    for (const bool cutting : {false, true}) {
      const Worst worst = worst_of(tasks, place, cutting);
      const std::string where = place.name() + (cutting ? ", cutting" : "") + ": ";
      const auto add = [&](const char* quantity, double value, const RowLimit& limit,
                           const Task* of = nullptr) {
        StabilityRow& row = trial.add(where + quantity, "", value, limit);
        row.burr_mm = 2e3 * place.head->radius_m;
        if (of) say_run(row, of->push);
      };
      add("runs", worst.runs, {});
      add("not held", worst.not_held, at_most(0.0));
      add("unstable", worst.unstable, at_most(0.0));
      add("rms of the handle over one resolution", worst.rms, at_most(1.0), worst.of_rms);
      if (!cutting) {
        add("felt share of the coupling", worst.whole_share,
            place.slides ? at_least({}) : at_least(kLeastShare), worst.of_whole);
        add("felt share of the coupling from 1 to 2 N", worst.share, at_least(kLeastShare),
            worst.of_share);
      }
      add("force_step_N", worst.step_N, {});
    }
  }
}

/// A tilted burr turns the handle of a device that renders torques.
void pressed_off_axis(CaseTrial& trial) {
  constexpr int kCells = 192;  // the handle's end turns with the burr, which then slides along
  const Site face = face_at(kFirstTilt_deg, kCells);
  Place place = place_over(face, kHeads[0]);
  place.axis = Eigen::AngleAxisd(15.0 * kDegree, Vector3d::UnitY()) * face.out;
  for (const std::string_view hand : kHandPresetNames) {
    for (const double force_N : {0.5, 1.0, 2.0}) {
      for (const int delay : {0, 1}) {
        Push push = push_at(place);
        push.device = "premium15";
        push.hand = hand;
        push.delay = delay;
        push.force_N = force_N;
        const PushResult r = run(push, place);
        const auto add = [&](const char* quantity, double value, const RowLimit& limit = {}) {
          say_run(trial.add(quantity, "", value, limit), push);
        };
        const DeviceSettings& device = device_preset(push.device);
        const double held_Nm = HandSettings{}.turning_stiffness_Nm_per_rad * r.turn;
        add("turned_deg", r.turn / kDegree);
        add("torque against the hand's spring_percent",
            100.0 * std::abs(held_Nm - r.torque_Nm) / std::max(1e-9, r.torque_Nm), at_most(5.0));
        add("rms of the turn over one resolution", r.turn_rms / device.angle_resolution,
            at_most(1.0));
        add("rms of the handle over one resolution", r.rms_m / r.resolution_m, at_most(1.0));
        add("popped through", !r.reached || r.popped, at_most(0.0));
      }
    }
    if (trial.brief) break;
  }
}

}  // namespace sulcus::lab
