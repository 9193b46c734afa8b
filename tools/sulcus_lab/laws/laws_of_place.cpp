#include <algorithm>
#include <string>
#include <vector>

#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

const std::vector<std::string> kSomeShapes{"box", "blob", "groove"};
const std::vector<std::string> kEveryShape{law_shape_names().begin(), law_shape_names().end()};

std::string kept_words(bool kept) { return kept ? "normals kept" : "normals found anew"; }

std::string kept_key(bool kept) { return kept ? "" : "keep_normals = false"; }

constexpr double kFast_m = 0.1e-3, kSlow_m = 10e-6;  // a tick: 100 and 10 mm/s

double distance_N(const Wrench& a, const Wrench& b) { return (a.force_N - b.force_N).norm(); }

/// Places of the ball's middle a little aside of where a shape is touched, and some depth below.
std::vector<Vector3d> places_in(const LawShape& shape, bool few) {
  struct Place {
    double across_mm, along_mm, depth_mm;
  };
  constexpr Place kPlaces[] = {{0.0, 0.0, 0.1},    {-0.11, 0.05, 0.05}, {0.07, -0.12, 0.15},
                               {0.21, 0.17, 0.02}, {-0.03, 0.22, 0.2},  {-0.2, -0.09, 0.08}};
  std::vector<Vector3d> places;
  for (const Place& place : std::span(kPlaces).first(few ? 2 : std::size(kPlaces))) {
    const Vector3d aside =
        kMillimetre * (place.across_mm * shape.across + place.along_mm * shape.along());
    places.push_back(touching_centre(shape, aside) - place.depth_mm * kMillimetre * shape.normal);
  }
  return places;
}

/// From `from` to a place, in steps of so much a tick.
TickResult come(LawRig& rig, const Vector3d& from, const Vector3d& place, double step_m) {
  return rig.steps(poses_along(std::vector<Vector3d>{from, place}, step_m));
}

}  // namespace

/// The tool comes down to a place at 100 mm/s, so that its normals are new, and stays there for a
/// hundred ticks. The force of all of them but the first is that of the second.
void at_rest(LawTrial& trial) {
  for (const std::string& name : trial.shapes(kSomeShapes, kEveryShape)) {
    const LawShape shape = law_shape(name, trial.surface());
    const std::vector<Vector3d> places = places_in(shape, trial.quick());
    for (const std::string& scaling : trial.scalings()) {
      for (const bool kept : {true, false}) {
        const Scene scene = law_scene({.scaling = scaling, .haptics = kept_key(kept)});
        double most_N = 0.0;
        for (const Vector3d& place : places) {
          LawRig rig(scene, shape.model);
          come(rig, place + 0.3e-3 * shape.normal, place, kFast_m);
          const Pose pose = pose_at_centre(place);
          const Wrench second = rig.step(pose).contact.wrench;
          for (int t = 2; t < 100; ++t) {
            most_N = std::max(most_N, distance_N(rig.step(pose).contact.wrench, second));
          }
        }
        trial.add({name, scaling, kept_words(kept)}, "change_N", most_N, at_most(0.0));
      }
    }
  }
}

/// The same place reached along the normal, slowly and fast, along the surface from each side, and
/// out of a deeper one: the force in the tick of the arrival and in the one after it.
void another_way(LawTrial& trial) {
  for (const std::string& name : trial.shapes(kSomeShapes, kEveryShape)) {
    const LawShape shape = law_shape(name, trial.surface());
    const std::vector<Vector3d> places = places_in(shape, trial.quick());
    struct Way {
      Vector3d from;  // the place
      double step_m;
    };
    const Way ways[] = {{0.3e-3 * shape.normal, kSlow_m},
                        {0.3e-3 * shape.normal, kFast_m},
                        {0.3e-3 * shape.across, kSlow_m},
                        {0.3e-3 * shape.along(), kFast_m},
                        {-0.25e-3 * shape.across, kSlow_m},
                        {-0.1e-3 * shape.normal + 0.1e-3 * shape.along(), kSlow_m}};
    for (const std::string& scaling : trial.scalings()) {
      for (const bool kept : {true, false}) {
        const Scene scene = law_scene({.scaling = scaling, .haptics = kept_key(kept)});
        double arriving_N = 0.0, arrived_N = 0.0;
        for (const Vector3d& place : places) {
          std::vector<Wrench> first, second;
          for (const Way& way : ways) {
            LawRig rig(scene, shape.model);
            first.push_back(come(rig, place + way.from, place, way.step_m).contact.wrench);
            second.push_back(rig.step(pose_at_centre(place)).contact.wrench);
          }
          for (std::size_t w = 1; w < first.size(); ++w) {
            arriving_N = std::max(arriving_N, distance_N(first[w], first[0]));
            arrived_N = std::max(arrived_N, distance_N(second[w], second[0]));
          }
        }
        const LawPlace where{name, scaling, kept_words(kept)};
        trial.add(where, "apart_on_arrival_N", arriving_N, at_most(0.0));
        trial.add(where, "apart_a_tick_later_N", arrived_N, at_most(0.0));
      }
    }
  }
}

}  // namespace sulcus::lab
