#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/LU>

#include "app/inspect/inspect.hpp"
#include "app/inspect/suggested_run.hpp"
#include "app/inspect/volume_facts.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

namespace {

void print_place(const MedicalVolume& volume) {
  const Eigen::Vector3d mm = volume.spacing_m / kMillimetre;
  const Eigen::Vector3d extent = volume.sizes.cast<double>().cwiseProduct(mm);
  const Eigen::Vector3d origin = volume.origin_m / kMillimetre;
  const Eigen::Matrix3d& d = volume.direction;
  say("volume           %d x %d x %d voxels\n", volume.sizes.x(), volume.sizes.y(),
      volume.sizes.z());
  if (volume.spacing_known) {
    say("spacing          %g x %g x %g mm\n", mm.x(), mm.y(), mm.z());
    say("extent           %g x %g x %g mm\n", extent.x(), extent.y(), extent.z());
  } else {
    say("spacing          not said by the file: --spacing-mm here, spacing_mm in a scene\n");
  }
  say("origin           %g, %g, %g mm\n", origin.x(), origin.y(), origin.z());
  constexpr double kSeen = 1e-3;
  const bool sheared = std::abs(std::abs(d.determinant()) - 1.0) > kSeen;
  const auto axis = [&d](Eigen::Index a) {  // rounded: no 2e-16, no -0
    return "(" + short_number(d(0, a)) + " " + short_number(d(1, a)) + " " + short_number(d(2, a)) +
           ")";
  };
  say("directions       %s, %s, %s%s\n", axis(0).c_str(), axis(1).c_str(), axis(2).c_str(),
      sheared ? ", not at right angles" : "");
  say("memory           %.1f MiB when read\n",
      static_cast<double>(volume.values.size() * InputLimits::kVoxelBytes) / kMebibyte);
}

/// " (12.3 mm3)", or nothing where the file does not say how large a voxel is.
std::string volume_text(const MedicalVolume& volume, double voxels) {
  if (!volume.spacing_known) return {};
  return formatted(" (%.3f mm3)", voxels * voxel_volume_mm3(volume));
}

/// A dozen rows, each a bar by the root of its count, so that little tissue is seen beside much
/// air.
void print_histogram(const GreyHistogram& histogram) {
  say("percentiles      1 %%: %s, 25 %%: %s, 50 %%: %s, 75 %%: %s, 99 %%: %s\n",
      short_number(histogram.quantile(0.01)).c_str(),
      short_number(histogram.quantile(0.25)).c_str(),
      short_number(histogram.quantile(0.50)).c_str(),
      short_number(histogram.quantile(0.75)).c_str(),
      short_number(histogram.quantile(0.99)).c_str());
  constexpr std::size_t kRows = 12, kBar = 40;
  const std::size_t bins = histogram.counts.size();
  const std::size_t each = (bins + kRows - 1) / kRows;
  std::vector<double> rows;
  for (std::size_t first = 0; first < bins; first += each) {
    double sum = 0.0;
    for (std::size_t i = first; i < std::min(first + each, bins); ++i) {
      sum += static_cast<double>(histogram.counts[i]);
    }
    rows.push_back(sum / static_cast<double>(histogram.total()));
  }
  const double most = *std::ranges::max_element(rows);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto bar = static_cast<std::size_t>(std::lround(kBar * std::sqrt(rows[row] / most)));
    say("%-16s %10s %5.1f %% %s\n", row == 0 ? "histogram from" : "",
        short_number(histogram.edge(row * each)).c_str(), 100.0 * rows[row],
        std::string(bar, '#').c_str());
  }
}

/// Each value with its box along the lattice, from the corner, and its middle in the file's space.
void print_labels(const MedicalVolume& volume, const std::vector<LabelCount>& labels) {
  const Eigen::Vector3d unit = volume.spacing_known
                                   ? Eigen::Vector3d(volume.spacing_m / kMillimetre)
                                   : Eigen::Vector3d::Ones();
  for (const LabelCount& label : labels) {
    const Eigen::Vector3i low(label.low), high(label.high);
    const Eigen::Vector3d from = low.cast<double>().cwiseProduct(unit);
    const Eigen::Vector3d to = (high.cast<double>() + Eigen::Vector3d::Ones()).cwiseProduct(unit);
    say("value %-10d %llu voxels%s, %.4g to %.4g, %.4g to %.4g, %.4g to %.4g %s", label.value,
        static_cast<unsigned long long>(label.voxels),
        volume_text(volume, static_cast<double>(label.voxels)).c_str(), from.x(), to.x(), from.y(),
        to.y(), from.z(), to.z(),
        volume.spacing_known ? "mm from the corner" : "voxels from the corner");
    if (volume.spacing_known) {
      const Eigen::Vector3d middle_mm =
          (volume.origin_m +
           volume.direction * Eigen::Vector3d(label.middle).cwiseProduct(volume.spacing_m)) /
          kMillimetre;
      say(", middle at (%.4f, %.4f, %.4f) mm", middle_mm.x(), middle_mm.y(), middle_mm.z());
    }
    say("\n");
  }
}

void print_thresholds(const VolumeFacts& facts) {
  if (!facts.two_classes) return;
  say("two classes      solid from %s (Otsu)%s\n", short_number(*facts.two_classes).c_str(),
      facts.enamel_above ? "" : ": suggested");
  if (facts.three_classes.size() == 2) {
    say("three classes    dentine from %s, enamel from %s (Otsu)%s\n",
        short_number(facts.three_classes[0]).c_str(), short_number(facts.three_classes[1]).c_str(),
        facts.enamel_above ? ": suggested" : ": not three");
  }
  if (facts.ramp) {
    say("fractions        at the surface empty at %s, full at %s in the mean\n",
        short_number((*facts.ramp)[0]).c_str(), short_number((*facts.ramp)[1]).c_str());
  }
}

}  // namespace

void inspect_volume(const std::string& file, const std::optional<Eigen::Vector3d>& spacing_m,
                    const std::string& picture_png) {
  MedicalVolume volume = read_medical_volume(file);
  if (spacing_m) {
    volume.spacing_m = *spacing_m;
    volume.spacing_known = true;
  }
  if (!volume.spacing_known && !picture_png.empty()) {
    throw InputError(file, "spacing", "none in the file", "--spacing-mm beside --picture");
  }
  const VolumeFacts facts = volume_facts(volume);
  const auto [least, most] = std::minmax_element(volume.values.begin(), volume.values.end());
  const auto above =
      std::count_if(volume.values.begin(), volume.values.end(), [](float v) { return v > 0.0f; });
  print_place(volume);
  say("values           %g to %g\n", static_cast<double>(*least), static_cast<double>(*most));
  say("voxels above 0   %td%s\n", above, volume_text(volume, static_cast<double>(above)).c_str());
  if (facts.labels.empty()) {
    print_histogram(facts.histogram);
    print_thresholds(facts);
  } else {
    print_labels(volume, facts.labels);
  }
  if (facts.solid) {
    say("solid            %llu voxels%s%s", static_cast<unsigned long long>(facts.solid->voxels),
        volume_text(volume, static_cast<double>(facts.solid->voxels)).c_str(),
        facts.solid->parts == 1 ? ", in one part"
        : facts.labels.empty()
            ? (", the largest of " + std::to_string(facts.solid->parts) + " parts").c_str()
            : (", in " + std::to_string(facts.solid->parts) + " parts").c_str());
    if (volume.spacing_known) {
      const Eigen::Vector3d size = facts.solid->box_file_m.sizes() / kMillimetre;
      say(", %.4g x %.4g x %.4g mm\n", size.x(), size.y(), size.z());
      say("to cut it        %s\n",
          cutting_command(volume, facts, spacing_m ? SpacingFrom::kUser : SpacingFrom::kFile)
              .c_str());
    } else {
      say("\n");
      say("to cut it        say how large its voxels are: --spacing-mm X Y Z\n");
    }
  }
  for (const std::string& warning : volume.warnings) {
    say("warning          %s\n", warning.c_str());
  }
  if (picture_png.empty()) return;
  if (!draw_volume(volume, facts, picture_png)) {
    throw std::runtime_error(picture_png + ": gnuplot could not draw it");
  }
}

}  // namespace sulcus
