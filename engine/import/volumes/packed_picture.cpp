#include "engine/import/volumes/packed_picture.hpp"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

#include <charls/charls.h>
#include <jpeglib.h>
#include <openjpeg.h>

namespace sulcus {
namespace {

/// Whether more stands behind a plane than fills its segment up: its picture is a larger one.
bool has_more_runs(std::span<const std::byte> rest) {
  constexpr auto kNothing = std::byte{0x80};  // a code that says so
  return std::ranges::count_if(rest, [](std::byte b) { return b != kNothing; }) > 1;
}

/// One plane of run lengths, PackBits; false: it ends too soon or too late.
bool unpack_runs(std::span<const std::byte> packed, std::span<std::byte> plane) {
  std::size_t at = 0, done = 0;
  while (done < plane.size()) {
    if (at >= packed.size()) return false;
    const int control = static_cast<std::int8_t>(packed[at++]);
    if (control == -128) continue;
    const auto count = static_cast<std::size_t>(control >= 0 ? control + 1 : 1 - control);
    const std::size_t taken = control >= 0 ? count : 1;
    if (taken > packed.size() - at || count > plane.size() - done) return false;
    if (control >= 0) {
      std::copy_n(packed.begin() + static_cast<std::ptrdiff_t>(at), count,
                  plane.begin() + static_cast<std::ptrdiff_t>(done));
    } else {
      std::fill_n(plane.begin() + static_cast<std::ptrdiff_t>(done), count, packed[at]);
    }
    at += taken;
    done += count;
  }
  return !has_more_runs(packed.subspan(at));
}

/// Whether a stream of JPEG's kind ends with its marker, up to the zeros that fill a fragment up.
bool has_end(std::span<const std::byte> packed) {
  while (!packed.empty() && packed.back() == std::byte{0}) packed = packed.first(packed.size() - 1);
  return packed.size() >= 2 && packed[packed.size() - 2] == std::byte{0xff} &&
         packed.back() == std::byte{0xd9};
}

/// Leaves libjpeg, which would end the program.
struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf leave;

  static void exit(j_common_ptr jpeg) {
    // The manager is the first member.
    std::longjmp(reinterpret_cast<JpegErrors*>(jpeg->err)->leave, 1);
  }
};

/// Holds nothing to be destroyed, since it is left by longjmp.
bool read_jpeg_rows(jpeg_decompress_struct& jpeg, JpegErrors& errors,
                    std::span<const std::byte> packed, std::uint32_t columns, std::uint32_t rows,
                    unsigned char* pixels) {
  if (setjmp(errors.leave) != 0) return false;  // NOLINT(cert-err52-cpp): libjpeg's way
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(packed.data()),
               static_cast<unsigned long>(packed.size()));
  if (jpeg_read_header(&jpeg, TRUE) != JPEG_HEADER_OK) return false;
  if (jpeg.image_width != columns || jpeg.image_height != rows || jpeg.num_components != 1 ||
      jpeg.data_precision != 8) {
    return false;
  }
  jpeg.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&jpeg);
  while (jpeg.output_scanline < rows) {
    unsigned char* row = pixels + std::size_t{jpeg.output_scanline} * columns;
    if (jpeg_read_scanlines(&jpeg, &row, 1) != 1) return false;
  }
  jpeg_finish_decompress(&jpeg);
  return jpeg.err->num_warnings == 0;  // as it counts what is damaged, and reads on
}

/// A codestream in memory, as OpenJPEG reads it.
struct MemoryStream {
  std::span<const std::byte> bytes;
  std::size_t at = 0;

  static OPJ_SIZE_T read(void* to, OPJ_SIZE_T wanted, void* self) {
    auto& stream = *static_cast<MemoryStream*>(self);
    const std::size_t got = std::min<std::size_t>(wanted, stream.bytes.size() - stream.at);
    if (got == 0) return std::numeric_limits<OPJ_SIZE_T>::max();
    std::memcpy(to, stream.bytes.data() + stream.at, got);
    stream.at += got;
    return got;
  }
  static OPJ_OFF_T skip(OPJ_OFF_T wanted, void* self) {
    auto& stream = *static_cast<MemoryStream*>(self);
    if (wanted < 0) return -1;
    const std::size_t got =
        std::min(static_cast<std::size_t>(wanted), stream.bytes.size() - stream.at);
    stream.at += got;
    return static_cast<OPJ_OFF_T>(got);
  }
  static OPJ_BOOL seek(OPJ_OFF_T to, void* self) {
    auto& stream = *static_cast<MemoryStream*>(self);
    if (to < 0 || static_cast<std::size_t>(to) > stream.bytes.size()) return OPJ_FALSE;
    stream.at = static_cast<std::size_t>(to);
    return OPJ_TRUE;
  }
};

}  // namespace

std::vector<std::int32_t> unpack_rle(std::span<const std::byte> packed, std::uint32_t columns,
                                     std::uint32_t rows, unsigned bytes_each) {
  constexpr std::size_t kHeader = 64;
  const auto word = [&](std::size_t i) {
    std::uint32_t value = 0;
    std::memcpy(&value, packed.data() + 4 * i, sizeof value);
    return value;
  };
  if (packed.size() < kHeader || word(0) != bytes_each) return {};
  const std::uint64_t plane_bytes = std::uint64_t{columns} * rows * bytes_each;
  if (packed.size() * kMostRleRatio < plane_bytes) return {};
  std::vector<std::int32_t> values(std::size_t{columns} * rows, 0);
  std::vector<std::byte> plane(values.size());
  for (std::size_t p = 0; p < bytes_each; ++p) {
    const std::size_t begin = word(p + 1), end = p + 1 < bytes_each ? word(p + 2) : packed.size();
    if (begin < kHeader || end > packed.size() || begin > end) return {};
    if (!unpack_runs(packed.subspan(begin, end - begin), plane)) return {};
    // The highest byte comes first.
    for (std::size_t v = 0; v < values.size(); ++v) {
      const auto value = static_cast<std::uint32_t>(values[v]) << 8u;
      values[v] = static_cast<std::int32_t>(value | static_cast<std::uint32_t>(plane[v]));
    }
  }
  return values;
}

std::optional<PictureSize> coded_size(std::span<const std::byte> packed) {
  const auto number = [&](std::size_t at, std::size_t digits) {
    std::uint32_t value = 0;
    for (std::size_t d = 0; d < digits; ++d) {
      value = value << 8u | static_cast<std::uint32_t>(packed[at + d]);
    }
    return value;
  };
  constexpr std::size_t kSizeEnd = 24;
  if (packed.size() < kSizeEnd) return std::nullopt;
  if (number(0, 4) == 0xff4fff51) {  // JPEG 2000: its size comes first [T.800, annex A.5.1]
    const std::uint32_t right = number(8, 4), bottom = number(12, 4);
    const std::uint32_t left = number(16, 4), top = number(20, 4);
    if (left > right || top > bottom) return std::nullopt;
    return PictureSize{right - left, bottom - top};
  }
  if (number(0, 2) != 0xffd8) return std::nullopt;
  for (std::size_t at = 2; at + 9 <= packed.size();) {
    if (number(at, 1) != 0xff) return std::nullopt;
    const std::uint32_t marker = number(at + 1, 1);
    if (marker == 0xff) {
      ++at;
      continue;
    }
    // Frames of JPEG [T.81, annex B.2.2], of which some numbers are other markers; of JPEG-LS.
    const bool other = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;
    if ((marker >= 0xc0 && marker <= 0xcf && !other) || marker == 0xf7) {
      return PictureSize{number(at + 7, 2), number(at + 5, 2)};
    }
    at += 2 + number(at + 2, 2);
  }
  return std::nullopt;
}

std::vector<std::int32_t> unpack_jpeg(std::span<const std::byte> packed, std::uint32_t columns,
                                      std::uint32_t rows) {
  std::vector<unsigned char> pixels(std::size_t{columns} * rows);
  jpeg_decompress_struct jpeg{};
  JpegErrors errors{};
  jpeg.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = JpegErrors::exit;
  errors.manager.output_message = [](j_common_ptr) {};
  const bool whole = read_jpeg_rows(jpeg, errors, packed, columns, rows, pixels.data());
  jpeg_destroy_decompress(&jpeg);
  if (!whole) return {};
  return {pixels.begin(), pixels.end()};
}

std::vector<std::int32_t> unpack_jpeg_ls(std::span<const std::byte> packed, std::uint32_t columns,
                                         std::uint32_t rows) {
  // Without its end the library goes on for seconds.
  if (!has_end(packed)) return {};
  const std::unique_ptr<charls_jpegls_decoder, decltype(&charls_jpegls_decoder_destroy)> decoder(
      charls_jpegls_decoder_create(), charls_jpegls_decoder_destroy);
  charls_frame_info frame{};
  const auto fine = [](charls_jpegls_errc code) { return code == charls_jpegls_errc{}; };
  if (!decoder ||
      !fine(charls_jpegls_decoder_set_source_buffer(decoder.get(), packed.data(), packed.size())) ||
      !fine(charls_jpegls_decoder_read_header(decoder.get())) ||
      !fine(charls_jpegls_decoder_get_frame_info(decoder.get(), &frame)) ||
      frame.width != columns || frame.height != rows || frame.component_count != 1 ||
      frame.bits_per_sample > 16) {
    return {};
  }
  const std::size_t pixels = std::size_t{columns} * rows;
  std::vector<std::uint8_t> bytes(pixels * (frame.bits_per_sample > 8 ? 2 : 1));
  if (!fine(charls_jpegls_decoder_decode_to_buffer(decoder.get(), bytes.data(), bytes.size(), 0))) {
    return {};
  }
  if (bytes.size() == pixels) return {bytes.begin(), bytes.end()};
  std::vector<std::uint16_t> words(pixels);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return {words.begin(), words.end()};
}

std::vector<std::int32_t> unpack_jpeg_2000(std::span<const std::byte> packed, std::uint32_t columns,
                                           std::uint32_t rows) {
  const std::unique_ptr<opj_codec_t, decltype(&opj_destroy_codec)> codec(
      opj_create_decompress(OPJ_CODEC_J2K), opj_destroy_codec);
  const std::unique_ptr<opj_stream_t, decltype(&opj_stream_destroy)> stream(
      opj_stream_default_create(OPJ_TRUE), opj_stream_destroy);
  if (!codec || !stream) return {};
  MemoryStream memory{packed};
  opj_stream_set_user_data(stream.get(), &memory, nullptr);
  opj_stream_set_user_data_length(stream.get(), packed.size());
  opj_stream_set_read_function(stream.get(), MemoryStream::read);
  opj_stream_set_skip_function(stream.get(), MemoryStream::skip);
  opj_stream_set_seek_function(stream.get(), MemoryStream::seek);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  if (opj_setup_decoder(codec.get(), &parameters) == OPJ_FALSE) return {};
  opj_image_t* read = nullptr;
  const bool header = opj_read_header(stream.get(), codec.get(), &read) != OPJ_FALSE;
  const std::unique_ptr<opj_image_t, decltype(&opj_image_destroy)> image(read, opj_image_destroy);
  if (!header || !image || image->numcomps != 1 || image->comps[0].w != columns ||
      image->comps[0].h != rows) {
    return {};
  }
  if (opj_decode(codec.get(), stream.get(), image.get()) == OPJ_FALSE ||
      opj_end_decompress(codec.get(), stream.get()) == OPJ_FALSE) {
    return {};
  }
  const opj_image_comp_t& grey = image->comps[0];
  if (grey.w != columns || grey.h != rows || grey.data == nullptr) return {};
  return {grey.data, grey.data + std::size_t{columns} * rows};
}

}  // namespace sulcus
