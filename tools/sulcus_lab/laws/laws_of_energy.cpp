#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kMicrojoule = 1e-6;
const std::vector<std::string> kFewWays{"box", "blob", "groove"};
const std::vector<std::string> kAllWays{law_shape_names().begin(), law_shape_names().end()};

/// What passes to whoever moves against a force, added up along a way.
struct EnergyOfWay {
  double given_J = 0.0;   // out of the contact, so far
  double stored_J = 0.0;  // the most that had been put in

  void add(double work_J) {
    given_J += work_J;
    stored_J = std::max(stored_J, -given_J);
  }
};

std::string way_words(double depth_m, bool back) {
  return with_number("%g mm deep ", depth_m / kMillimetre) + (back ? "back" : "forth");
}

/// Once round a closed way that begins and ends in free air. Force in straight lines from pose to
/// pose.
template <class Step>
EnergyOfWay turn_round(const std::vector<Vector3d>& way, const Step& step) {
  EnergyOfWay energy;
  Vector3d before_N = step(way.front());
  for (std::size_t i = 1; i <= way.size(); ++i) {
    const Vector3d& from = way[i - 1];
    const Vector3d& to = way[i % way.size()];
    const Vector3d force_N = step(to);
    energy.add(0.5 * (before_N + force_N).dot(to - from));
    before_N = force_N;
  }
  return energy;
}

/// The trajectory of a hand that goes round a way, again and again.
Trajectory round_and_round(const std::vector<Vector3d>& way, int turns) {
  std::vector<TimedPose> poses;
  poses.reserve(way.size() * static_cast<std::size_t>(turns));
  for (int turn = 0; turn < turns; ++turn) {
    for (const Vector3d& centre : way) {
      poses.push_back({1e-3 * static_cast<double>(poses.size()), pose_at_centre(centre)});
    }
  }
  return Trajectory(std::move(poses));
}

}  // namespace

/// The tool is taken round a circle across the edge of a shape. What it gives out a turn, in either
/// direction, is nothing. The second turn counts: normals have settled.
void closed_way(LawTrial& trial) {
  const double step_m = trial.quick() ? 5e-6 : 2e-6;
  for (const std::string& name : trial.shapes(kFewWays, kAllWays)) {
    const LawShape shape = law_shape(name, trial.surface());
    for (const std::string& scaling : trial.scalings()) {
      for (const double depth_m : trial.settings<double>({0.1e-3}, {0.05e-3, 0.1e-3, 0.2e-3})) {
        EnergyOfWay energies[2];
        for (const bool back : {false, true}) {
          const std::vector<Vector3d> way = circle_over(shape, depth_m, 0.3e-3, step_m, back);
          LawRig rig(law_scene({.scaling = scaling}), shape.model);
          const auto step = [&](const Vector3d& centre) -> Vector3d {
            return rig.step(pose_at_centre(centre)).contact.wrench.force_N;
          };
          turn_round(way, step);
          energies[back ? 1 : 0] = turn_round(way, step);
        }
        // A force without a potential may store next to nothing one way round.
        const double stored_J = std::max(energies[0].stored_J, energies[1].stored_J);
        for (const bool back : {false, true}) {
          const double given_J = energies[back ? 1 : 0].given_J;
          const LawPlace where{name, scaling, way_words(depth_m, back)};
          trial.add(where, "stored_uJ", energies[back ? 1 : 0].stored_J / kMicrojoule);
          trial.add(where, "given_out_uJ", given_J / kMicrojoule);
          trial.add(where, "given_out_of_stored_percent", 100.0 * given_J / stored_J,
                    wanted_of_potential(scaling, 0.5));
        }
      }
    }
  }
}

/// The same of a device that the tool hangs on, at 4 mm/s: what its springs give out a turn.
void coupled_way(LawTrial& trial) {
  for (const std::string& name : trial.shapes(kFewWays, kAllWays)) {
    const LawShape shape = law_shape(name, trial.surface());
    for (const std::string& scaling : trial.scalings()) {
      for (const double depth_m : trial.settings<double>({0.3e-3}, {0.1e-3, 0.3e-3})) {
        for (const bool back : {false, true}) {
          const std::vector<Vector3d> way = circle_over(shape, depth_m, 0.3e-3, 4e-6, back);
          LawRig rig(law_scene({.scaling = scaling, .coupling = true}), shape.model);
          const auto step = [&](const Vector3d& centre) -> Vector3d {
            return rig.step(pose_at_centre(centre)).commanded.force_N;
          };
          turn_round(way, step);
          const EnergyOfWay energy = turn_round(way, step);
          const LawPlace where{name, scaling, way_words(depth_m, back)};
          trial.add(where, "stored_uJ", energy.stored_J / kMicrojoule);
          trial.add(where, "given_out_uJ", energy.given_J / kMicrojoule,
                    wanted_of_potential(scaling, 0.2));
        }
      }
    }
  }
}

namespace {

/// What a simulated device was given in a turn of its hand, from the handle's own motion under the
/// force that it held. In the mean of the turns but the first.
EnergyOfWay energy_at_port(const Scene& scene, const LawShape& shape,
                           const std::vector<Vector3d>& way, int turns) {
  const Trajectory hand = round_and_round(way, 1 + turns);
  SimulatedDevice device(*scene.device, hand, scene.haptics.rate_hz, scene.burr.reference_m);
  LawRig rig(scene, shape.model);
  EnergyOfWay mean;
  Vector3d sent_N = Vector3d::Zero(), before = device.state().position;
  for (int turn = 0; turn <= turns; ++turn) {
    EnergyOfWay energy;
    for (std::size_t t = 0; t < way.size(); ++t) {
      const TickResult result = rig.step(device);
      const Vector3d now = device.state().position;
      energy.add(sent_N.dot(now - before));
      before = now;
      sent_N = result.sent.force_N;
    }
    if (turn == 0) continue;
    mean.given_J += energy.given_J / turns;
    mean.stored_J += energy.stored_J / turns;
  }
  return mean;
}

}  // namespace

/// The same of a simulated device whose hand goes round at 3 mm/s, with and without the passivity
/// controller.
void device_way(LawTrial& trial) {
  const int turns = trial.quick() ? 2 : 6;
  for (const std::string& name : trial.shapes({"box", "wall"}, kAllWays)) {
    const LawShape shape = law_shape(name, trial.surface());
    for (const std::string& scaling : trial.scalings()) {
      for (const bool controlled : {false, true}) {
        const Scene scene =
            law_scene({.scaling = scaling,
                       .tables = std::string("[device]\nmodel = 'simulated'\npreset = 'touch'\n"
                                             "hand = 'firm'\npassivity_controller = ") +
                                 (controlled ? "true\n" : "false\n"),
                       .coupling = true});
        for (const double depth_m : trial.settings<double>({0.4e-3}, {0.4e-3, 0.6e-3})) {
          for (const bool back : {false, true}) {
            const std::vector<Vector3d> way = circle_over(shape, depth_m, 0.3e-3, 3e-6, back);
            const EnergyOfWay energy = energy_at_port(scene, shape, way, turns);
            const LawPlace where{
                name, scaling,
                way_words(depth_m, back) + (controlled ? " controlled" : " not controlled")};
            trial.add(where, "stored_uJ", energy.stored_J / kMicrojoule);
            trial.add(where, "given_out_uJ", energy.given_J / kMicrojoule,
                      controlled ? at_most(0.0) : RowLimit{});
          }
        }
      }
    }
  }
}

}  // namespace sulcus::lab
