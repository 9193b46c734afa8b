#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <tiffio.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/number_type.hpp"
#include "engine/import/volumes/tiff_text.hpp"
#include "engine/import/volumes/volume_checks.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

// What LZW makes of one byte at most: codes of 12 bits for strings of up to 3,839.
constexpr std::uint64_t kMaxTiffRatio = 4096;
constexpr std::uint64_t kMaxOtherRatio = std::uint64_t{1} << 20;
constexpr std::array<int, 7> kLossless{
    COMPRESSION_NONE,     COMPRESSION_LZW,  COMPRESSION_ADOBE_DEFLATE, COMPRESSION_DEFLATE,
    COMPRESSION_PACKBITS, COMPRESSION_LZMA, COMPRESSION_ZSTD};

using Tiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;

/// How a page is stored.
struct TiffForm {
  std::uint32_t width = 0, height = 0;  // as they are stored
  std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT;
  std::uint16_t compression = COMPRESSION_NONE;
  std::uint16_t orientation = ORIENTATION_TOPLEFT;
  bool tiled = false, white_is_zero = false;

  /// Whether what is stored means the same; how it is packed may differ from page to page.
  bool is_like(const TiffForm& other) const {
    return width == other.width && height == other.height && bits == other.bits &&
           format == other.format && orientation == other.orientation &&
           white_is_zero == other.white_is_zero;
  }
  std::uint64_t row_bytes() const { return (std::uint64_t{width} * bits + 7) / 8; }
  std::size_t pixels() const { return std::size_t{width} * height; }
  /// What a page may be of at least, packed as it is.
  double least_bytes() const {
    const bool newer = compression == COMPRESSION_LZMA || compression == COMPRESSION_ZSTD;
    const std::uint64_t ratio = compression == COMPRESSION_NONE ? 1
                                : newer                         ? kMaxOtherRatio
                                                                : kMaxTiffRatio;
    return static_cast<double>(row_bytes() * height) / static_cast<double>(ratio);
  }
  bool transposed() const { return orientation >= ORIENTATION_LEFTTOP; }
};

Tiff open_tiff(const std::string& file) {
  // Errors are reported in one line, by exception.
  TIFFSetWarningHandler(nullptr);
  TIFFSetErrorHandler(nullptr);
  Tiff tiff(TIFFOpen(file.c_str(), "rm"), TIFFClose);
  if (!tiff) throw InputError(file, "header", "contents that cannot be one", "a TIFF file");
  return tiff;
}

std::string page_place(unsigned page) { return "page " + std::to_string(page); }

/// A tile in memory.
struct TileSize {
  std::uint32_t width = 0, height = 0;
  std::uint64_t row_bytes = 0;
};

/// Of the page at which `tiff` stands. @throws InputError: none, or one far beyond the picture.
TileSize tile_size(const std::string& file, unsigned page, TIFF* tiff, const TiffForm& form) {
  TileSize tile;
  TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile.width);
  TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile.height);
  constexpr std::uint32_t kMostSide = 1 << 14, kStep = 16;  // sides are multiples of it
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 24;
  const auto rounded = [](std::uint64_t side) { return (side + kStep - 1) / kStep * kStep; };
  tile.row_bytes = (std::uint64_t{tile.width} * form.bits + 7) / 8;
  const bool fine =
      tile.width > 0 && tile.height > 0 && tile.width <= kMostSide && tile.height <= kMostSide &&
      std::uint64_t{tile.width} * tile.height <=
          std::max(kMostPixels, rounded(form.width) * rounded(form.height)) &&
      static_cast<std::uint64_t>(TIFFTileSize64(tiff)) == tile.row_bytes * tile.height;
  if (!fine) {
    throw InputError(file, page_place(page),
                     "tiles of " + std::to_string(tile.width) + " x " + std::to_string(tile.height),
                     "tiles of the size of the picture, or smaller");
  }
  return tile;
}

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
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &form.orientation);
  std::uint16_t samples = 1, photometric = PHOTOMETRIC_MINISBLACK;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  std::uint32_t kind = 0;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &kind);
  form.white_is_zero = photometric == PHOTOMETRIC_MINISWHITE;
  std::uint32_t depth = 1;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_IMAGEDEPTH, &depth);
  if (depth > 1) {
    refuse("an ImageDepth of " + std::to_string(depth), "a page for each slice");
  }
  if (samples != 1 || (photometric != PHOTOMETRIC_MINISBLACK && !form.white_is_zero)) {
    refuse("colours (" + std::to_string(samples) + " samples, photometric " +
               std::to_string(photometric) + ")",
           "one grey value a pixel");
  }
  const bool words = form.bits == 8 || form.bits == 16 || form.bits == 32 || form.bits == 64;
  const bool known = form.format == SAMPLEFORMAT_UINT  ? words || (form.bits > 0 && form.bits < 16)
                     : form.format == SAMPLEFORMAT_INT ? words
                                                       : form.format == SAMPLEFORMAT_IEEEFP &&
                                                             (form.bits == 32 || form.bits == 64);
  if (!known) {
    refuse(std::to_string(form.bits) + " bits of sample format " + std::to_string(form.format),
           "1 to 16, 32 or 64 bits, or a float of 32 or 64");
  }
  if (std::ranges::find(kLossless, form.compression) == kLossless.end() ||
      TIFFIsCODECConfigured(form.compression) == 0) {
    refuse("compression " + std::to_string(form.compression),
           "none, LZW, deflate, PackBits, LZMA or Zstandard");
  }
  form.tiled = TIFFIsTiled(tiff) != 0;
  if ((kind & ~std::uint32_t{FILETYPE_PAGE}) != 0) {
    refuse("a reduced image or a mask", "pages of the volume alone");
  }
  if (form.orientation < ORIENTATION_TOPLEFT || form.orientation > ORIENTATION_LEFTBOT) {
    refuse("orientation " + std::to_string(form.orientation), "1 to 8");
  }
  if (static_cast<std::uint64_t>(TIFFScanlineSize64(tiff)) != form.row_bytes()) {
    refuse("rows of another length", std::to_string(form.row_bytes()) + " bytes");
  }
  if (form.tiled) (void)tile_size(file, page, tiff, form);
  return form;
}

/// Whether the file holds the whole of the number that says where the next page is. The library
/// would take one that is cut off for a 0, which ends the file.
bool holds_next_page(std::istream& in, std::uint64_t file_bytes, TIFF* tiff) {
  const bool big = TIFFIsBigTIFF(tiff) != 0;
  std::array<unsigned char, 8> raw{};
  const std::size_t digits = big ? 8 : 2;
  const std::uint64_t at = TIFFCurrentDirOffset(tiff);
  in.seekg(static_cast<std::streamoff>(at));
  in.read(reinterpret_cast<char*>(raw.data()), static_cast<std::streamsize>(digits));
  std::uint64_t entries = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    entries = entries << 8u | raw[TIFFIsBigEndian(tiff) != 0 ? d : digits - 1 - d];
  }
  const std::uint64_t entry = big ? 20 : 12, pointer = big ? 8 : 4;
  return in.good() && entries < file_bytes && at + digits + entries * entry + pointer <= file_bytes;
}

/// Goes through the pages of a file; how many there are.
unsigned check_pages(const std::string& file, const InputLimits& limits, TiffForm& first,
                     bool is_first) {
  const Tiff tiff = open_tiff(file);
  const std::uint64_t held = std::filesystem::file_size(file);
  std::ifstream in(file, std::ios::binary);
  double least = 0.0;
  unsigned pages = 0;
  while (true) {
    const TiffForm form = form_of(file, pages, tiff.get());
    if (is_first && pages == 0) first = form;
    if (!form.is_like(first)) {
      throw InputError(file, page_place(pages), "a page of another form", "that of the first");
    }
    if (!holds_next_page(in, held, tiff.get())) {
      throw InputError(file, page_place(pages), "a page that is cut off", "a whole TIFF file");
    }
    least += form.least_bytes();
    ++pages;
    const std::array<std::int64_t, 3> sizes{first.width, first.height, pages};
    checked_voxel_count(file, "sizes", sizes, limits);
    if (TIFFLastDirectory(tiff.get()) != 0) break;
    // The library would take a page that is cut off for the end.
    if (TIFFReadDirectory(tiff.get()) == 0) {
      throw InputError(file, page_place(pages), "a page that cannot be read", "a whole TIFF file");
    }
  }
  if (static_cast<double>(held) < std::floor(least)) {
    throw InputError(file, "data", std::to_string(held) + " bytes",
                     "at least " + std::to_string(static_cast<std::uint64_t>(least)));
  }
  return pages;
}

/// A row of stored numbers; those of less than a byte, and of 9 to 15 bits, lie bit behind bit.
void convert(const TiffForm& form, std::span<const std::byte> row, std::span<float> values) {
  using Kind = NumberType::Kind;
  const Kind kind = form.format == SAMPLEFORMAT_IEEEFP ? Kind::kFloat
                    : form.format == SAMPLEFORMAT_INT  ? Kind::kSigned
                                                       : Kind::kUnsigned;
  if (form.bits % 8 == 0) return to_floats(row, {kind, form.bits / 8u}, false, values);
  std::size_t bit = 0;
  for (float& value : values) {
    unsigned number = 0;
    for (unsigned b = 0; b < form.bits; ++b, ++bit) {
      const auto byte = static_cast<unsigned>(row[bit / 8]);
      number = number << 1u | (byte >> (7u - bit % 8u) & 1u);
    }
    value = static_cast<float>(number);
  }
}

[[noreturn]] void refuse_pixels(const std::string& file, unsigned page, const std::string& place) {
  throw InputError(file, page_place(page) + ", " + place, "pixels that cannot be read",
                   "a whole TIFF file");
}

/// The page at which `tiff` stands, as it is stored.
void read_strips(const std::string& file, unsigned page, TIFF* tiff, const TiffForm& form,
                 std::span<float> stored) {
  std::vector<std::byte> row(form.row_bytes());
  for (std::uint32_t line = 0; line < form.height; ++line) {
    if (TIFFReadScanline(tiff, row.data(), line) != 1) {
      refuse_pixels(file, page, "row " + std::to_string(line));
    }
    convert(form, row, stored.subspan(std::size_t{line} * form.width, form.width));
  }
}

void read_tiles(const std::string& file, unsigned page, TIFF* tiff, const TiffForm& form,
                std::span<float> stored) {
  const auto [width, height, row_bytes] = tile_size(file, page, tiff, form);
  std::vector<std::byte> tile(row_bytes * height);
  std::vector<float> row(width);
  for (std::uint32_t y = 0; y < form.height; y += height) {
    for (std::uint32_t x = 0; x < form.width; x += width) {
      if (TIFFReadTile(tiff, tile.data(), x, y, 0, 0) < 0) {
        refuse_pixels(file, page, "tile " + std::to_string(x) + ", " + std::to_string(y));
      }
      const std::uint32_t columns = std::min(width, form.width - x);
      for (std::uint32_t r = 0; r < std::min(height, form.height - y); ++r) {
        convert(form, std::span(tile).subspan(r * row_bytes, row_bytes), row);
        std::copy_n(
            row.begin(), columns,
            stored.begin() + static_cast<std::ptrdiff_t>(std::size_t{y + r} * form.width + x));
      }
    }
  }
}

/// Where its orientation puts what is stored in column `c` and row `r` [TIFF 6.0, "Orientation"].
std::size_t upright(const TiffForm& form, std::uint32_t c, std::uint32_t r) {
  const auto is_one_of = [&](std::initializer_list<int> orientations) {
    return std::ranges::find(orientations, form.orientation) != orientations.end();
  };
  const bool turned = form.transposed();
  const std::uint32_t width = turned ? form.height : form.width;
  const std::uint32_t height = turned ? form.width : form.height;
  std::uint32_t x = turned ? r : c, y = turned ? c : r;
  if (is_one_of({ORIENTATION_TOPRIGHT, ORIENTATION_BOTRIGHT, ORIENTATION_RIGHTTOP,
                 ORIENTATION_RIGHTBOT})) {
    x = width - 1 - x;
  }
  if (is_one_of(
          {ORIENTATION_BOTLEFT, ORIENTATION_BOTRIGHT, ORIENTATION_LEFTBOT, ORIENTATION_RIGHTBOT})) {
    y = height - 1 - y;
  }
  return std::size_t{y} * width + x;
}

/// All pages into `values`; where the next file's begin.
float* read_pages(const std::string& file, const TiffForm& form, unsigned pages, float* values) {
  const Tiff tiff = open_tiff(file);
  std::vector<float> stored(form.orientation == ORIENTATION_TOPLEFT ? 0 : form.pixels());
  for (unsigned page = 0; page < pages; ++page) {
    // The form once more: the file may have been written to.
    const bool found = page == 0 || TIFFReadDirectory(tiff.get()) != 0;
    const TiffForm own = found ? form_of(file, page, tiff.get()) : TiffForm{};
    if (!own.is_like(form)) {
      throw InputError(file, page_place(page), "a page that changed", "a whole TIFF file");
    }
    const std::span<float> out(values, form.pixels());
    const std::span<float> as_stored = stored.empty() ? out : std::span<float>(stored);
    (own.tiled ? read_tiles : read_strips)(file, page, tiff.get(), own, as_stored);
    for (std::size_t p = 0; p < stored.size(); ++p) {
      out[upright(form, static_cast<std::uint32_t>(p % form.width),
                  static_cast<std::uint32_t>(p / form.width))] = stored[p];
    }
    values += form.pixels();
  }
  return values;
}

/// What the first page says of the stack.
TiffText described_in(const std::string& file) {
  const Tiff tiff = open_tiff(file);
  const char* description = nullptr;
  if (TIFFGetField(tiff.get(), TIFFTAG_IMAGEDESCRIPTION, &description) != 1 || !description)
    return {};
  return read_tiff_text(file, description);
}

/// Pages of a file, of those before it, and of all.
struct PageCounts {
  std::int64_t own = 0, before = 0, all = 0;
};

/// Refuses pages that are another thing than slices, one behind the other.
void check_text(const std::string& file, const TiffText& text, const TiffForm& form,
                const PageCounts& pages) {
  constexpr const char* kPlace = "ImageDescription";
  if (!text.one_stack) {
    throw InputError(file, kPlace, "several channels or points in time", "one stack of slices");
  }
  // Files of one stack may each describe the whole of it.
  const bool of_all = text.slices && *text.slices != pages.own;
  if (of_all && *text.slices != pages.all) {
    throw InputError(file, kPlace, std::to_string(*text.slices) + " slices",
                     std::to_string(pages.own) + ", as many as there are pages");
  }
  const std::string name = std::filesystem::path(file).filename().string();
  for (const TiffTextBlock& block : text.blocks) {
    const bool named = !block.file.empty();
    if (of_all && named && block.file != name) continue;
    const std::int64_t ahead = block.slice - block.page;
    if (ahead == (of_all ? pages.before : 0) || (ahead == 0 && !named)) continue;
    throw InputError(file, "TiffData",
                     "slice " + std::to_string(block.slice) + " of the stack on page " +
                         std::to_string(block.page),
                     "pages in the order of the slices");
  }
  // Each series of tifffile's has a shape of its own: a smaller one is not that of all pages.
  double shape = text.shape.empty() ? 0.0 : 1.0;
  for (const std::int64_t size : text.shape) shape *= static_cast<double>(size);
  const auto pixels = static_cast<double>(form.pixels());
  if (shape > pixels * static_cast<double>(pages.own) &&
      shape != pixels * static_cast<double>(pages.all)) {
    throw InputError(file, kPlace, "a shape of more pixels than there are",
                     "that of the pages, which are " + std::to_string(pages.own));
  }
}

/// What the first page says of the size of voxels.
void take_spacing(const std::string& file, const TiffForm& form, TiffText text,
                  MedicalVolume& volume) {
  if (!text.unknown_unit.empty()) {
    throw InputError(file, "unit", "\"" + text.unknown_unit + "\"", "mm, um or another length");
  }
  const Tiff tiff = open_tiff(file);
  float across = 0.0f, down = 0.0f;  // pixels for a unit
  if (text.unit_m && TIFFGetField(tiff.get(), TIFFTAG_XRESOLUTION, &across) == 1 &&
      TIFFGetField(tiff.get(), TIFFTAG_YRESOLUTION, &down) == 1 && across > 0.0f && down > 0.0f) {
    text.x_m = *text.unit_m / static_cast<double>(across);
    text.y_m = *text.unit_m / static_cast<double>(down);
  }
  if (!text.x_m || !text.y_m || !text.z_m) return;
  if (form.transposed()) std::swap(text.x_m, text.y_m);
  volume.spacing_m = {*text.x_m, *text.y_m, *text.z_m};
  for (int d = 0; d < 3; ++d) check_spacing(file, "spacing", volume.spacing_m[d] * 1e3);
  volume.spacing_known = true;
}

}  // namespace

MedicalVolume read_tiff_volume(std::span<const std::string> files, const InputLimits& limits) {
  TiffForm form;
  std::vector<unsigned> pages;
  std::int64_t all = 0;
  for (const std::string& file : files) {
    pages.push_back(check_pages(file, limits, form, pages.empty()));
    all += pages.back();
    const std::array<std::int64_t, 3> sizes{form.width, form.height, all};
    checked_voxel_count(file, "sizes", sizes, limits);
  }
  MedicalVolume volume;
  volume.file = files.front();
  volume.spacing_known = false;
  std::int64_t before = 0;
  for (std::size_t f = 0; f < files.size(); ++f) {
    const TiffText text = described_in(files[f]);
    check_text(files[f], text, form, {.own = pages[f], .before = before, .all = all});
    before += pages[f];
    // Of a folder it is asked for: its files are slices, which do not know how far they lie apart.
    if (files.size() == 1) take_spacing(files[f], form, text, volume);
  }
  if (form.white_is_zero) {
    volume.warnings.emplace_back("0 is white in it, a matter of display: values stay as stored");
  }
  std::array<std::int64_t, 3> sizes{form.width, form.height, all};
  if (form.transposed()) std::swap(sizes[0], sizes[1]);
  set_sizes(volume, sizes);
  float* values = volume.values.data();
  for (std::size_t f = 0; f < files.size(); ++f) {
    values = read_pages(files[f], form, pages[f], values);
  }
  return volume;
}

}  // namespace sulcus
