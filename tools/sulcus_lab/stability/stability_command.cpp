#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "app/build_info.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/force_traces.hpp"
#include "tools/sulcus_lab/stability/frontier.hpp"
#include "tools/sulcus_lab/stability/random_pushes.hpp"
#include "tools/sulcus_lab/stability/stability_page.hpp"

namespace sulcus::lab {

namespace {

constexpr const char* kRandom = "random_pushes";
constexpr const char* kFrontier = "frontier";

struct StabilityOptions {
  std::string folder = "out/lab/stability";
  std::vector<std::string> cases;  // none: all
  std::vector<std::string> methods{kContactMethodNames.begin(), kContactMethodNames.end()};
  std::vector<std::string> teeth;  // scenes with the workpieces of random pushes, beside the molar
  std::vector<std::uint64_t> seeds;
  int pushes = 1000;
  bool brief = false;
};

/// The workpieces of random pushes, with their names.
std::vector<std::pair<std::string, Workpiece>> teeth_of(const StabilityOptions& options) {
  std::vector<std::pair<std::string, Workpiece>> teeth;
  const Scene molar = parse_scene(
      "[workpiece]\nshape = 'molar'\n[trajectory]\npoints_mm = [[0, 0, 9]]\n", "stability");
  teeth.emplace_back("molar", Workpiece(build_workpiece(molar)));
  for (const std::string& file : options.teeth) {
    teeth.emplace_back(std::filesystem::path(file).stem().string(),
                       Workpiece(build_workpiece(load_scene(file))));
  }
  return teeth;
}

CaseResult random_pushes(const StabilityOptions& options) {
  CaseResult result;
  const auto teeth = teeth_of(options);
  for (std::size_t t = 0; t < teeth.size(); ++t) {
    std::vector<std::uint64_t> seeds = options.seeds;
    if (seeds.empty()) {
      // All pushes shared out among the teeth.
      const auto each =
          static_cast<std::size_t>(options.brief ? 40 : options.pushes) / teeth.size();
      seeds.resize(each);
      std::iota(seeds.begin(), seeds.end(), t * each);
    }
    const std::vector<RandomPush> pushes = run_random_pushes(teeth[t].second, seeds);
    constexpr double kLimit_N = CouplingSettings{}.force_limit_N;
    for (const RandomPush& p : pushes) {
      if (!fails(p, kLimit_N) && options.seeds.empty()) continue;
      std::printf("%s: seed %llu, %s at %.1f mm/s%s: force %.3f N, step %.3f N%s%s\n",
                  teeth[t].first.c_str(), static_cast<unsigned long long>(p.seed), p.burr.c_str(),
                  p.speed_mm_per_s, p.cutting ? ", cutting" : "", p.force_N, p.step_N,
                  p.crossed ? ", crossed" : "", p.finite ? "" : ", not finite");
    }
    const CaseResult rows = random_push_rows(teeth[t].first, pushes, kLimit_N);
    result.rows.insert(result.rows.end(), rows.rows.begin(), rows.rows.end());
  }
  return result;
}

std::vector<ContactMethod> methods_of(const StabilityOptions& options) {
  std::vector<ContactMethod> methods;
  for (const std::string& name : options.methods) {
    const auto at = std::find(kContactMethodNames.begin(), kContactMethodNames.end(), name);
    methods.push_back(static_cast<ContactMethod>(at - kContactMethodNames.begin()));
  }
  return methods;
}

std::string row_cell(double value) { return with_number("%.6g", value); }

void write_row(CsvFile& csv, const StabilityRow& row) {
  std::ostringstream line;
  line << row.case_name << ',' << name_of(row.method) << ',' << row.device << ',' << row.hand << ','
       << row_cell(row.burr_mm) << ',' << row.delay << ',' << row_cell(row.push_N) << ",\""
       << row.quantity << "\"," << row_cell(row.value) << ','
       << (row.limit ? row_cell(*row.limit) + (row.pass() ? ",yes" : ",no") : ",");
  csv.write(line.str());
}

/// A line for each method: how many of the case's limits it met.
void print_case(const std::string& name, const CaseResult& result,
                std::span<const ContactMethod> methods) {
  std::printf("%-20s", name.c_str());
  for (const ContactMethod method : methods) {
    int held = 0, failed = 0;
    for (const StabilityRow& row : result.rows) {
      if (row.method != method || !row.limit) continue;
      ++(row.pass() ? held : failed);
    }
    if (held + failed == 0) continue;
    std::printf("  %s %d/%d", name_of(method).c_str(), held, held + failed);
  }
  std::printf("\n");
  std::fflush(stdout);
}

class StabilityRun {
 public:
  explicit StabilityRun(const StabilityOptions& options)
      : options_(options),
        methods_(methods_of(options)),
        results_(options.folder),
        csv_(results_.table("stability.csv"),
             "case,method,device,hand,burr_mm,delay,push_N,quantity,value,limit,pass") {}

  bool wants(std::string_view name) const {
    return options_.cases.empty() ||
           std::ranges::find(options_.cases, name) != options_.cases.end();
  }

  template <class Measure>
  void run(const std::string& name, const Measure& measure) {
    if (!wants(name)) return;
    progress_.say(name);
    const CaseResult result = measure();
    progress_.clear();
    print_case(name, result, methods_);
    for (const StabilityRow& row : result.rows) write_row(csv_, row);
    rows_.insert(rows_.end(), result.rows.begin(), result.rows.end());
    if (result.traces.empty()) return;
    const std::string picture = "stability_" + name;
    write_force_traces(result.traces, results_.table(picture + ".csv"));
    if (results_.draw("stability_forces", picture, name)) {
      pictures_.of_cases[name] = picture + ".png";
    }
  }

  void charts() {
    if (!wants(kFrontier)) return;
    progress_.say(kFrontier);
    chart("stability_frontier", "method,contacts,felt_hold_N_per_mm,felt_buzz_N_per_mm",
          measure_frontier(options_.brief), pictures_.frontier, [](const FrontierPoint& p) {
            return name_of(p.method) + "," + row_cell(p.contacts) + "," +
                   row_cell(p.felt_hold_N_per_mm) + "," + row_cell(p.felt_buzz_N_per_mm);
          });
    chart("stability_damping", "loop,damping_N_s_per_m,largest_stable_N_per_mm", measure_damping(),
          pictures_.damping, [](const DampingPoint& p) {
            return text_cell(p.label) + "," + row_cell(p.damping_N_s_per_m) + "," +
                   row_cell(p.largest_stable_N_per_mm);
          });
    chart("stability_speed_error", "method,tick_us,force_error_percent", measure_speed_error(),
          pictures_.speed_error, [](const SpeedErrorPoint& p) {
            return name_of(p.method) + "," + row_cell(p.tick_us) + "," +
                   row_cell(p.force_error_percent);
          });
    progress_.clear();
  }

  /// How many rows of the default method miss their limits.
  int finish() {
    const std::string page = results_.table("stability.html");
    const std::vector<std::string> remarks{"Measured by sulcus-lab stability, build " +
                                           std::string(build_info()) + "."};
    write_whole_file(page, stability_page(rows_, pictures_, remarks));
    results_.print();
    return static_cast<int>(std::ranges::count_if(rows_, [](const StabilityRow& row) {
      return row.method == ContactMethod::kCoupling && !row.pass();
    }));
  }

  std::span<const ContactMethod> methods() const { return methods_; }

 private:
  /// NAME.csv, a line for each point, and its chart; `on_page`: the picture's name once it is
  /// drawn.
  template <class Point, class Line>
  void chart(const std::string& name, const std::string& header, const std::vector<Point>& points,
             std::string& on_page, const Line& line) {
    CsvFile csv(results_.table(name + ".csv"), header);
    for (const Point& point : points) csv.write(line(point));
    if (results_.draw(name, name)) on_page = name + ".png";
  }

  const StabilityOptions& options_;
  std::vector<ContactMethod> methods_;
  Results results_;
  CsvFile csv_;
  ProgressLine progress_;
  std::vector<StabilityRow> rows_;
  StabilityPictures pictures_;
};

void stability(const StabilityOptions& options) {
  StabilityRun run(options);
  for (const StabilityCase& c : stability_cases()) {
    run.run(std::string(c.name), [&] { return run_case(c.name, {run.methods(), options.brief}); });
  }
  run.run(kRandom, [&] { return random_pushes(options); });
  run.charts();
  const int missed = run.finish();
  if (missed > 0) std::printf("The coupling misses %d limits.\n", missed);
}

}  // namespace

void add_stability_command(CLI::App& program) {
  auto options = std::make_shared<StabilityOptions>();
  CLI::App* command = program.add_subcommand(
      "stability", "Where haptic methods fail: twenty cases, clinical pushes, random trials");
  std::vector<std::string> names;
  for (const StabilityCase& c : stability_cases()) names.emplace_back(c.name);
  for (const char* name : {kRandom, kFrontier}) names.emplace_back(name);
  command->add_option("--case", options->cases, "Cases, comma separated (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_option("--method", options->methods, "Methods, comma separated (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(
          std::vector<std::string>(kContactMethodNames.begin(), kContactMethodNames.end())));
  command
      ->add_option("--tooth", options->teeth,
                   "Scene whose workpiece random pushes are also made on; repeatable")
      ->expected(1)
      ->take_all();
  command->add_option("--pushes", options->pushes, "Random pushes on all teeth (1000)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--seed", options->seeds, "Only these random pushes, comma separated")
      ->delimiter(',');
  command->add_flag("--brief", options->brief, "Fewer settings of everything");
  command->add_option("-o", options->folder, "Folder for the results (out/lab/stability)");
  command->footer(
      "Writes into the folder:\n"
      "  stability.html   what was tried, what failed, pictures of the force over time\n"
      "  stability.csv    case,method,device,hand,burr_mm,delay,push_N,quantity,value,limit,pass\n"
      "  stability_CASE.csv, stability_CASE.png   run,method,label,time_s,force_N,depth_mm\n"
      "  stability_frontier.csv, stability_damping.csv, stability_speed_error.csv, and a chart "
      "of each\n"
      "Cases: harness (the simulated loop against its spectral radius and the delay rule), the\n"
      "twenty of the page, pressed_off_axis, clinical_pushes, coupled_tick (its cost), "
      "random_pushes,\n"
      "frontier (the charts).");
  command->callback([options] { stability(*options); });
}

}  // namespace sulcus::lab
