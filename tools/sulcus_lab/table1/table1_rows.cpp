#include "tools/sulcus_lab/table1/table1_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sulcus::lab {

namespace {

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
constexpr double kMilli = 1e-3;

struct PaperFigure {
  std::string_view quantity;
  double probing, cutting;
};
/// [Kim and Park 2019, Table 1 and VI-A, VI-B].
constexpr PaperFigure kPaper[] = {
    {"leaves_in_contact_mean", 48, 83},
    {"voxels_in_contact_mean", 10, 351},
    {"voxels_tested_mean", 9333, 17577},
    {"voxels_in_contact_max", 69, 1180},
    {"tick_mean_us", 92, 468},
    {"force_rmse_N", 0.13, 0.15},
    {"torque_rmse_mNm", 5.01, 6.33},
    {"offline_tick_mean_us", 1800, 40670},
    {"speed_ratio", 20, 87},
    {"force_difference_max_N", kNotGiven, 0.4686},
    {"force_difference_max_tick", kNotGiven, 12546},
    {"voxels_in_contact_max_tick", kNotGiven, 6554},
    {"voxels_removed", kNotGiven, 10103},
    {"ticks", kNotGiven, 20000},
};

double paper_figure(std::string_view experiment, std::string_view quantity) {
  if (experiment != "probing" && experiment != "cutting") return kNotGiven;
  for (const PaperFigure& figure : kPaper) {
    if (figure.quantity == quantity) {
      return experiment == "probing" ? figure.probing : figure.cutting;
    }
  }
  return kNotGiven;
}

/// Root of the mean square.
class Rms {
 public:
  void add(double value) {
    sum_ += value * value;
    ++count_;
  }
  double value() const { return count_ > 0 ? std::sqrt(sum_ / static_cast<double>(count_)) : 0.0; }

 private:
  double sum_ = 0.0;
  std::uint64_t count_ = 0;
};

/// Forces and torques of one column.
struct Levels {
  double force_mean_N = 0.0, force_max_N = 0.0, force_rms_N = 0.0;
  double torque_mean_mNm = 0.0, torque_max_mNm = 0.0, torque_rms_mNm = 0.0;
};
Levels levels(std::span<const ComparedTick> ticks, Wrench ComparedTick::*of) {
  Levels found;
  Rms force, torque;
  for (const ComparedTick& tick : ticks) {
    const double force_N = (tick.*of).force_N.norm();
    const double torque_mNm = (tick.*of).torque_Nm.norm() / kMilli;
    found.force_mean_N += force_N / static_cast<double>(ticks.size());
    found.torque_mean_mNm += torque_mNm / static_cast<double>(ticks.size());
    found.force_max_N = std::max(found.force_max_N, force_N);
    found.torque_max_mNm = std::max(found.torque_max_mNm, torque_mNm);
    force.add(force_N);
    torque.add(torque_mNm);
  }
  found.force_rms_N = force.value();
  found.torque_rms_mNm = torque.value();
  return found;
}

double per(double sum, double count) { return count > 0.0 ? sum / count : 0.0; }

/// How far both are from the analytic normals.
template <class Add>
void add_truth(const Table1Run& run, const Add& add) {
  const WrenchErrors ours = wrench_errors(run.compared, &ComparedTick::ours, &ComparedTick::truth);
  const WrenchErrors exact =
      wrench_errors(run.compared, &ComparedTick::exact, &ComparedTick::truth);
  add("truth_force_rmse_N", ours.force_rmse_N, exact.force_rmse_N);
  add("truth_torque_rmse_mNm", ours.torque_rmse_mNm, exact.torque_rmse_mNm);
  add("truth_force_bias_N", ours.force_bias_N, exact.force_bias_N);
  add("truth_force_vector_rmse_N", ours.force_vector_rmse_N, exact.force_vector_rmse_N);
  add("truth_torque_vector_rmse_mNm", ours.torque_vector_rmse_mNm, exact.torque_vector_rmse_mNm);
  add("truth_force_difference_max_N", ours.force_max_N, exact.force_max_N);
  add("truth_torque_difference_max_mNm", ours.torque_max_mNm, exact.torque_max_mNm);
  add("truth_normal_error_mean_deg", run.ours_to_truth.mean_deg(), run.exact_to_truth.mean_deg());
  add("truth_normal_error_max_deg", run.ours_to_truth.max_deg, run.exact_to_truth.max_deg);
}

}  // namespace

WrenchErrors wrench_errors(std::span<const ComparedTick> ticks, Wrench ComparedTick::*of,
                           Wrench ComparedTick::*against) {
  WrenchErrors errors;
  Rms force, torque, force_vector, torque_vector;
  for (const ComparedTick& tick : ticks) {
    const Wrench &a = tick.*of, &b = tick.*against;
    const double force_N = a.force_N.norm() - b.force_N.norm();
    const double torque_mNm = (a.torque_Nm.norm() - b.torque_Nm.norm()) / kMilli;
    force.add(force_N);
    torque.add(torque_mNm);
    errors.force_bias_N += force_N / static_cast<double>(ticks.size());
    force_vector.add((a.force_N - b.force_N).norm());
    torque_vector.add((a.torque_Nm - b.torque_Nm).norm() / kMilli);
    if (std::abs(force_N) > errors.force_max_N) {
      errors.force_max_N = std::abs(force_N);
      errors.force_max_tick = tick.tick;
    }
    errors.torque_max_mNm = std::max(errors.torque_max_mNm, std::abs(torque_mNm));
  }
  errors.force_rmse_N = force.value();
  errors.torque_rmse_mNm = torque.value();
  errors.force_vector_rmse_N = force_vector.value();
  errors.torque_vector_rmse_mNm = torque_vector.value();
  return errors;
}

std::vector<Table1Row> table1_rows(std::string_view experiment, const Table1Run& run) {
  std::vector<Table1Row> rows;
  const auto add = [&](std::string_view quantity, double ours, double exact = kNotGiven) {
    rows.push_back({std::string(experiment), std::string(quantity),
                    paper_figure(experiment, quantity), ours, exact});
  };

  const auto ticks = static_cast<double>(run.contacts.size());
  double contacts_sum = 0.0;
  for (const std::uint32_t n : run.contacts) contacts_sum += n;
  const auto most = std::max_element(run.contacts.begin(), run.contacts.end());
  const auto compared = static_cast<double>(run.compared.size());
  const WrenchErrors to_exact =
      wrench_errors(run.compared, &ComparedTick::ours, &ComparedTick::exact);
  // A tick of the reference is the tick with another stage of normals.
  const double offline_us = run.tick_us_mean + per(run.exact_us - run.ours_us, compared);

  add("leaves_in_contact_mean", run.leaves_mean);
  add("voxels_in_contact_mean", per(contacts_sum, ticks));
  add("voxels_tested_mean", run.tested_mean);
  add("voxels_in_contact_max", *most);
  add("tick_mean_us", run.tick_us_mean, offline_us);
  add("force_rmse_N", to_exact.force_rmse_N);
  add("torque_rmse_mNm", to_exact.torque_rmse_mNm);

  add("offline_tick_mean_us", kNotGiven, offline_us);
  add("speed_ratio", per(offline_us, run.tick_us_mean), 1.0);
  add("force_difference_max_N", to_exact.force_max_N);
  add("force_difference_max_tick", static_cast<double>(to_exact.force_max_tick));
  add("torque_difference_max_mNm", to_exact.torque_max_mNm);
  add("voxels_in_contact_max_tick", static_cast<double>(most - run.contacts.begin()));
  add("voxels_removed", static_cast<double>(run.removed_voxels));
  add("ticks", ticks);
  add("ticks_compared", compared);

  const Levels ours = levels(run.compared, &ComparedTick::ours);
  const Levels exact = levels(run.compared, &ComparedTick::exact);
  add("force_mean_N", ours.force_mean_N, exact.force_mean_N);
  add("force_max_N", ours.force_max_N, exact.force_max_N);
  add("torque_mean_mNm", ours.torque_mean_mNm, exact.torque_mean_mNm);
  add("torque_max_mNm", ours.torque_max_mNm, exact.torque_max_mNm);
  add("force_rmse_percent_of_rms", 100.0 * per(to_exact.force_rmse_N, exact.force_rms_N));
  add("torque_rmse_percent_of_rms", 100.0 * per(to_exact.torque_rmse_mNm, exact.torque_rms_mNm));
  add("force_vector_rmse_N", to_exact.force_vector_rmse_N);
  add("torque_vector_rmse_mNm", to_exact.torque_vector_rmse_mNm);

  constexpr const char* kByAxes[] = {"voxels_without_direction_mean", "voxels_uni_directional_mean",
                                     "voxels_bi_directional_mean", "voxels_tri_directional_mean"};
  for (const int axes : {1, 2, 3, 0}) {
    add(kByAxes[axes],
        per(static_cast<double>(run.by_axes[static_cast<std::size_t>(axes)]), compared));
  }
  const auto normals = static_cast<double>(run.normals);
  add("normal_mean_us", per(run.ours_us, normals), per(run.exact_us, normals));
  add("normal_difference_mean_deg", run.ours_to_exact.mean_deg());
  add("normal_difference_max_deg", run.ours_to_exact.max_deg);
  if (run.has_truth) add_truth(run, add);
  return rows;
}

}  // namespace sulcus::lab
