#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/import/volumes/dicom_data_set.hpp"

namespace sulcus {

/// Values that measure nothing: what fills a slice up around what was scanned.
struct DicomPadding {
  float least = 0.0f, most = 0.0f;  // both are padding
};

/// How the pixels of a DICOM file are stored [DICOM PS3.3, C.7.6.3; padding C.7.5.1.1.2].
struct DicomPixelForm {
  std::uint32_t columns = 0, rows = 0, frames = 1;
  unsigned allocated = 16, stored = 16, high_bit = 15;
  bool is_signed = false;
  std::optional<DicomPadding> padding;

  std::size_t pixels() const { return std::size_t{columns} * rows; }
  std::uint64_t frame_bytes() const { return std::uint64_t{pixels()} * allocated / 8; }
};

/// Reads what a file says of its pixels, and sees that there are as many as it says.
/// @throws InputError: colours, or another form that is not read.
DicomPixelForm dicom_pixel_form(const DicomFile& file);

/// The values of a frame as they are stored, neither rescaled nor turned over; NaN where they are
/// padding. Plain, RLE, JPEG (8 bits, and lossless), JPEG-LS, JPEG 2000.
/// @throws InputError: damaged, or packed in another way.
void read_dicom_frame(const DicomFile& file, const DicomPixelForm& form, std::uint32_t frame,
                      std::span<float> values);

}  // namespace sulcus
