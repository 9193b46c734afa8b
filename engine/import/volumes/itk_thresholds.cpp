#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <itkHistogram.h>
#include <itkOtsuMultipleThresholdsCalculator.h>

#include "engine/import/volumes/grey_histogram.hpp"

// Beside itk_volume_writer.cpp the only file that knows ITK.

namespace sulcus {

std::vector<double> otsu_thresholds(const GreyHistogram& histogram, int count) {
  const auto filled = std::ranges::count_if(histogram.counts, [](auto n) { return n > 0; });
  const int most = std::min(count, static_cast<int>(filled) - 1);
  if (most < 1) return {};
  using Histogram = itk::Statistics::Histogram<double>;
  auto bins = Histogram::New();
  bins->SetMeasurementVectorSize(1);
  Histogram::SizeType size(1);
  size.Fill(histogram.counts.size());
  Histogram::MeasurementVectorType low(1), high(1);
  low.Fill(histogram.low);
  high.Fill(histogram.edge(histogram.counts.size()));
  bins->Initialize(size, low, high);
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    bins->SetFrequency(i, histogram.counts[i]);
  }
  auto otsu = itk::OtsuMultipleThresholdsCalculator<Histogram>::New();
  otsu->SetInputHistogram(bins);
  otsu->SetNumberOfThresholds(static_cast<itk::SizeValueType>(most));
  otsu->Compute();
  // ITK gives the upper end of a class's last bin, the first of all that are as good where the bins
  // above it are empty. Their middle is as far from the one class as from the other.
  std::vector<double> thresholds;
  for (const double value : otsu->GetOutput()) {
    const double bin = std::round((value - histogram.low) / histogram.width);
    std::size_t first = static_cast<std::size_t>(bin), end = first;
    while (first > 0 && histogram.counts[first - 1] == 0) --first;
    while (end < histogram.counts.size() && histogram.counts[end] == 0) ++end;
    thresholds.push_back(0.5 * (histogram.edge(first) + histogram.edge(end)));
  }
  return thresholds;
}

}  // namespace sulcus
