#include "engine/import/tiff_volume.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include <tiffio.h>

#include "engine/core/error.hpp"
#include "engine/import/volume_header.hpp"

namespace sulcus {
namespace {

// What LZW makes of one byte at most: codes of 12 bits for strings of up to 3,839.
constexpr std::uint64_t kMaxTiffRatio = 4096;
constexpr std::array<int, 5> kLossless{COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                       COMPRESSION_DEFLATE, COMPRESSION_PACKBITS};

using Tiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;

/// What must be the same of all pages.
struct TiffForm {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT;
  std::uint16_t compression = COMPRESSION_NONE;
  bool bottom_up = false;

  bool operator==(const TiffForm&) const = default;
  std::uint64_t row_bytes() const { return std::uint64_t{width} * (bits / 8u); }
};

Tiff open(const std::string& file) {
  // Errors are told in one line, by exception.
  TIFFSetWarningHandler(nullptr);
  TIFFSetErrorHandler(nullptr);
  Tiff tiff(TIFFOpen(file.c_str(), "rm"), TIFFClose);
  if (!tiff) throw InputError(file, "header", "contents that cannot be one", "a TIFF file");
  return tiff;
}

std::string page_place(unsigned page) { return "page " + std::to_string(page); }

/// Of the page at which `tiff` stands.
TiffForm form_of(const std::string& file, unsigned page, TIFF* tiff) {
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw InputError(file, page_place(page), found, expected);
  };
  TiffForm form;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &form.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &form.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &form.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &form.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &form.compression);
  std::uint16_t samples = 1, photometric = PHOTOMETRIC_MINISBLACK,
                orientation = ORIENTATION_TOPLEFT;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &orientation);
  std::uint32_t kind = 0;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &kind);
  if (samples != 1 || photometric != PHOTOMETRIC_MINISBLACK) {
    refuse("colours (" + std::to_string(samples) + " samples, photometric " +
               std::to_string(photometric) + ")",
           "one grey value a pixel, 0 for black");
  }
  const bool known = form.format == SAMPLEFORMAT_UINT || form.format == SAMPLEFORMAT_INT
                         ? form.bits == 8 || form.bits == 16 || form.bits == 32
                         : form.format == SAMPLEFORMAT_IEEEFP && form.bits == 32;
  if (!known) {
    refuse(std::to_string(form.bits) + " bits of sample format " + std::to_string(form.format),
           "8, 16 or 32 bits, or a float of 32");
  }
  if (std::ranges::find(kLossless, form.compression) == kLossless.end()) {
    refuse("compression " + std::to_string(form.compression), "none, LZW, deflate or PackBits");
  }
  if (TIFFIsTiled(tiff) != 0) refuse("tiles", "strips");
  if ((kind & ~std::uint32_t{FILETYPE_PAGE}) != 0) {
    refuse("a reduced image or a mask", "pages of the volume alone");
  }
  if (orientation != ORIENTATION_TOPLEFT && orientation != ORIENTATION_BOTLEFT) {
    refuse("orientation " + std::to_string(orientation), "rows from the left");
  }
  form.bottom_up = orientation == ORIENTATION_BOTLEFT;
  if (static_cast<std::uint64_t>(TIFFScanlineSize64(tiff)) != form.row_bytes()) {
    refuse("rows of another length", std::to_string(form.row_bytes()) + " bytes");
  }
  return form;
}

/// Goes through the pages of a file; how many there are.
unsigned check_pages(const std::string& file, const InputLimits& limits, TiffForm& first,
                     bool is_first) {
  const Tiff tiff = open(file);
  unsigned pages = 0;
  do {
    const TiffForm form = form_of(file, pages, tiff.get());
    if (is_first && pages == 0) first = form;
    if (form != first) {
      throw InputError(file, page_place(pages), "a page of another form", "that of the first");
    }
    ++pages;
    const std::array<std::int64_t, 3> sizes{first.width, first.height, pages};
    checked_voxel_count(file, "sizes", sizes, limits);
  } while (TIFFReadDirectory(tiff.get()) != 0);
  if (TIFFNumberOfDirectories(tiff.get()) != pages) {
    throw InputError(file, page_place(pages), "a page that cannot be read", "a whole TIFF file");
  }
  const std::uint64_t announced = first.row_bytes() * first.height * pages;
  const std::uint64_t ratio = first.compression == COMPRESSION_NONE ? 1 : kMaxTiffRatio;
  if (const std::uint64_t held = std::filesystem::file_size(file); held < announced / ratio) {
    throw InputError(file, "data", std::to_string(held) + " bytes",
                     "at least " + std::to_string(announced / ratio));
  }
  return pages;
}

template <class T>
void convert(const std::vector<std::byte>& row, float* values) {
  for (std::size_t at = 0; at < row.size(); at += sizeof(T)) {
    T grey;
    std::memcpy(&grey, row.data() + at, sizeof grey);
    *values++ = static_cast<float>(grey);
  }
}

void convert(const TiffForm& form, const std::vector<std::byte>& row, float* values) {
  const bool whole = form.format == SAMPLEFORMAT_UINT;
  if (form.format == SAMPLEFORMAT_IEEEFP) return convert<float>(row, values);
  if (form.bits == 8) {
    return whole ? convert<std::uint8_t>(row, values) : convert<std::int8_t>(row, values);
  }
  if (form.bits == 16) {
    return whole ? convert<std::uint16_t>(row, values) : convert<std::int16_t>(row, values);
  }
  return whole ? convert<std::uint32_t>(row, values) : convert<std::int32_t>(row, values);
}

/// All pages into `values`; where the next file's begin.
float* read_pages(const std::string& file, const TiffForm& form, unsigned pages, float* values) {
  const Tiff tiff = open(file);
  std::vector<std::byte> row(form.row_bytes());
  for (unsigned page = 0; page < pages; ++page) {
    // The form once more: the file may have been written to.
    if ((page > 0 && TIFFReadDirectory(tiff.get()) == 0) ||
        form_of(file, page, tiff.get()) != form) {
      throw InputError(file, page_place(page), "a page that changed", "a whole TIFF file");
    }
    for (std::uint32_t line = 0; line < form.height; ++line) {
      if (TIFFReadScanline(tiff.get(), row.data(), line) != 1) {
        throw InputError(file, page_place(page) + ", row " + std::to_string(line),
                         "pixels that cannot be read", "a whole TIFF file");
      }
      const std::uint32_t at = form.bottom_up ? form.height - 1 - line : line;
      convert(form, row, values + std::size_t{at} * form.width);
    }
    values += std::size_t{form.width} * form.height;
  }
  return values;
}

}  // namespace

ItkVolume read_tiff_volume(std::span<const std::string> files, const InputLimits& limits) {
  TiffForm form;
  std::vector<unsigned> pages;
  std::int64_t all = 0;
  std::uint64_t voxels = 0;
  for (const std::string& file : files) {
    pages.push_back(check_pages(file, limits, form, pages.empty()));
    all += pages.back();
    const std::array<std::int64_t, 3> sizes{form.width, form.height, all};
    voxels = checked_voxel_count(file, "sizes", sizes, limits);
  }
  ItkVolume volume;
  volume.spacing_known = false;  // the resolution of a TIFF is that of a print
  volume.spacing_m = {1e-3, 1e-3, 1e-3};
  volume.sizes = {static_cast<int>(form.width), static_cast<int>(form.height),
                  static_cast<int>(all)};
  for (std::size_t d = 0; d < 3; ++d) volume.axes[d][d] = 1.0;
  volume.values.resize(voxels);
  float* values = volume.values.data();
  for (std::size_t f = 0; f < files.size(); ++f) {
    values = read_pages(files[f], form, pages[f], values);
  }
  return volume;
}

}  // namespace sulcus
