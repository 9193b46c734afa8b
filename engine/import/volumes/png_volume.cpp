#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include <png.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/volume_checks.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

// What deflate makes of one byte at most.
constexpr std::uint64_t kMaxPngRatio = 1032;

/// What must be the same of all slices.
struct PngForm {
  std::uint32_t width = 0, height = 0;
  int bits = 0;

  bool operator==(const PngForm&) const = default;
  /// Of numbers below a byte each in a byte of its own.
  std::uint64_t row_bytes() const { return std::uint64_t{width} * (bits == 16 ? 2u : 1u); }
  std::uint64_t stored_bytes() const {
    return (std::uint64_t{width} * static_cast<std::uint64_t>(bits) + 7) / 8 * height;
  }
};

/// A PNG that is being read. Its library leaves by longjmp: the calls of it stand in functions of
/// their own that hold nothing to be destroyed.
class PngFile {
 public:
  explicit PngFile(const std::string& file)
      : name_(file), file_(std::fopen(file.c_str(), "rb"), std::fclose) {
    if (!file_) throw InputError(file, "", "no readable file", "a PNG slice");
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, say_nothing);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
    if (!info_ || !read_header()) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      throw InputError(file, "header", "contents that cannot be one", "a PNG file");
    }
  }
  ~PngFile() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  /// Refuses what is no plain grey slice.
  PngForm form() const {
    const int depth = png_get_bit_depth(png_, info_), colours = png_get_color_type(png_, info_);
    if (colours != PNG_COLOR_TYPE_GRAY) {
      throw InputError(name_, "colour type", std::to_string(colours), "0: grey alone");
    }
    return {png_get_image_width(png_, info_), png_get_image_height(png_, info_), depth};
  }

  /// All rows, big-endian; called once.
  void read(const PngForm& form, std::vector<std::uint8_t>& bytes) {
    std::vector<std::uint8_t*> rows(form.height);
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = bytes.data() + r * form.row_bytes();
    if (!read_rows(rows.data())) {
      throw InputError(name_, "data", "pixels that cannot be read", "a whole PNG file");
    }
  }

 private:
  // The library would tell its reasons to the error stream; an error here is one line.
  static void say_nothing(png_structp, png_const_charp) {}
  [[noreturn]] static void leave(png_structp png, png_const_charp) { png_longjmp(png, 1); }

  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng's way
    png_init_io(png_, file_.get());
    png_read_info(png_, info_);
    return true;
  }
  bool read_rows(std::uint8_t** rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;  // NOLINT(cert-err52-cpp)
    png_set_packing(png_);
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  const std::string& name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

MedicalVolume read_png_volume(std::span<const std::string> files, const InputLimits& limits) {
  PngForm form;
  for (std::size_t f = 0; f < files.size(); ++f) {
    const PngForm here = PngFile(files[f]).form();
    if (f == 0) form = here;
    if (here != form) {
      throw InputError(files[f], "", "a slice of another size or depth", "that of the first");
    }
    const std::array<std::int64_t, 3> sizes{form.width, form.height,
                                            static_cast<std::int64_t>(files.size())};
    checked_voxel_count(files[f], "sizes", sizes, limits);
    const std::uint64_t least = form.stored_bytes() / kMaxPngRatio;
    if (const std::uint64_t held = std::filesystem::file_size(files[f]); held < least) {
      throw InputError(files[f], "data", std::to_string(held) + " bytes",
                       "at least " + std::to_string(least));
    }
  }
  MedicalVolume volume;
  volume.file = files.front();
  volume.spacing_known = false;  // what a PNG says is the size of a pixel on a page
  set_sizes(volume, std::array<std::int64_t, 3>{form.width, form.height,
                                                static_cast<std::int64_t>(files.size())});
  const std::size_t pixels = std::size_t{form.width} * form.height;
  std::vector<std::uint8_t> bytes(form.row_bytes() * form.height);
  float* value = volume.values.data();
  for (const std::string& file : files) {
    PngFile png(file);
    // The form once more: the file may have been written to.
    if (png.form() != form) throw InputError(file, "", "a slice that changed", "a whole PNG file");
    png.read(form, bytes);
    for (std::size_t p = 0; p < pixels; ++p) {
      *value++ = form.bits != 16 ? static_cast<float>(bytes[p])
                                 : static_cast<float>(bytes[2 * p] << 8 | bytes[2 * p + 1]);
    }
  }
  return volume;
}

}  // namespace sulcus
