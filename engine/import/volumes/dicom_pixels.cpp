#include "engine/import/volumes/dicom_pixels.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/import/volumes/packed_picture.hpp"
#include "engine/import/volumes/text_header.hpp"

namespace sulcus {
namespace {

/// DICOM's names of ways to pack [DICOM PS3.6, annex A].
constexpr std::string_view kDeflatedPixels = "1.2.840.10008.1.2.1.99",
                           kPlain = "1.2.840.10008.1.2.1.98", kRle = "1.2.840.10008.1.2.5",
                           kJpeg = "1.2.840.10008.1.2.4.50",
                           kJpegExtended = "1.2.840.10008.1.2.4.51",
                           kJpegLossless = "1.2.840.10008.1.2.4.57",
                           kJpegLosslessFirst = "1.2.840.10008.1.2.4.70",
                           kJpegLsLossless = "1.2.840.10008.1.2.4.80",
                           kJpegLs = "1.2.840.10008.1.2.4.81",
                           kJpeg2000Lossless = "1.2.840.10008.1.2.4.90",
                           kJpeg2000 = "1.2.840.10008.1.2.4.91";

bool is_native(const std::string& syntax) {
  return syntax == "1.2.840.10008.1.2" || syntax == "1.2.840.10008.1.2.1" ||
         syntax == "1.2.840.10008.1.2.2" || syntax == kDeflatedPixels;
}

std::uint16_t needed_word(const DicomFile& file, DicomTag tag, const char* name) {
  const auto value = file.data.word(tag);
  if (!value) throw InputError(file.path, name, "no such element", "one");
  return *value;
}

[[noreturn]] void refuse_length(const DicomFile& file, std::uint64_t held,
                                std::uint64_t announced) {
  throw InputError(file.path, "PixelData", std::to_string(held) + " bytes",
                   std::to_string(announced) + " of rows, columns and frames");
}

/// Whether a fragment begins a picture of its own.
bool begins_picture(std::span<const std::byte> fragment) {
  return fragment.size() > 2 && fragment[0] == std::byte{0xff} &&
         (fragment[1] == std::byte{0xd8} || fragment[1] == std::byte{0x4f});
}

/// The packed bytes of a frame, whose fragments may be several.
std::vector<std::byte> packed_frame(const DicomFile& file, const DicomElement& pixels,
                                    const DicomPixelForm& form, std::uint32_t frame) {
  const auto all = std::span(pixels.fragments).subspan(1);
  std::size_t first = frame, end = frame + 1;
  if (form.frames == 1) {
    first = 0, end = all.size();
  } else if (all.size() != form.frames) {
    std::vector<std::size_t> begins;
    for (std::size_t f = 0; f < all.size(); ++f) {
      if (begins_picture(all[f])) begins.push_back(f);
    }
    if (begins.size() != form.frames) {
      throw InputError(file.path, "PixelData", std::to_string(all.size()) + " fragments",
                       std::to_string(form.frames) + " frames");
    }
    first = begins[frame];
    end = frame + 1 < form.frames ? begins[frame + 1] : all.size();
  }
  std::vector<std::byte> packed;
  for (std::size_t f = first; f < end; ++f) {
    packed.insert(packed.end(), all[f].begin(), all[f].end());
  }
  return packed;
}

std::vector<std::int32_t> unpacked(const DicomFile& file, const DicomPixelForm& form,
                                   std::span<const std::byte> packed) {
  const std::string& syntax = file.transfer_syntax;
  if (syntax == kRle) return unpack_rle(packed, form.columns, form.rows, form.allocated / 8);
  if (syntax == kJpeg || syntax == kJpegExtended)
    return unpack_jpeg(packed, form.columns, form.rows);
  if (syntax == kJpegLossless || syntax == kJpegLosslessFirst) {
    const auto samples = read_lossless_jpeg(packed, form.columns, form.rows);
    return {samples.begin(), samples.end()};
  }
  if (syntax == kJpegLsLossless || syntax == kJpegLs) {
    return unpack_jpeg_ls(packed, form.columns, form.rows);
  }
  return unpack_jpeg_2000(packed, form.columns, form.rows);
}

bool is_unpacked_here(const std::string& syntax) {
  return syntax == kRle || syntax == kJpeg || syntax == kJpegExtended || syntax == kJpegLossless ||
         syntax == kJpegLosslessFirst || syntax == kJpegLsLossless || syntax == kJpegLs ||
         syntax == kJpeg2000Lossless || syntax == kJpeg2000 || syntax == kPlain;
}

/// Refuses packed pixels that cannot be of the size which is said, before memory is taken for it.
void check_packed_size(const DicomFile& file, const DicomElement& pixels,
                       const DicomPixelForm& form) {
  const std::string& syntax = file.transfer_syntax;
  if (syntax == kRle || syntax == kPlain) {
    std::uint64_t held = 0;
    for (const auto& fragment : std::span(pixels.fragments).subspan(1)) held += fragment.size();
    const std::uint64_t announced = form.frame_bytes() * form.frames;
    if (syntax == kPlain && held < announced) refuse_length(file, held, announced);
    if (held >= announced / kMostRleRatio) return;
    throw InputError(
        file.path, "PixelData", std::to_string(held) + " bytes of run lengths",
        "at least " + std::to_string(announced / kMostRleRatio) + " for rows, columns and frames");
  }
  const auto coded = coded_size(packed_frame(file, pixels, form, 0));
  if (coded && coded->columns == form.columns && coded->rows == form.rows) return;
  const auto text = [](std::uint32_t columns, std::uint32_t rows) {
    return std::to_string(columns) + " x " + std::to_string(rows);
  };
  throw InputError(file.path, "PixelData",
                   coded ? "a picture of " + text(coded->columns, coded->rows)
                         : "packed pixels that are damaged",
                   "a whole picture of " + text(form.columns, form.rows));
}

/// A stored word as the number that its bits from `high_bit` down say.
float value_of(std::uint32_t word, const DicomPixelForm& form) {
  word >>= form.high_bit + 1 - form.stored;
  if (form.stored < 32) word &= (std::uint32_t{1} << form.stored) - 1;
  const std::uint32_t sign = std::uint32_t{1} << (form.stored - 1);
  if (form.is_signed && (word & sign) != 0) {
    return static_cast<float>(static_cast<double>(word) - 2.0 * static_cast<double>(sign));
  }
  return static_cast<float>(word);
}

void take_plain(std::span<const std::byte> bytes, const DicomPixelForm& form, bool big_endian,
                std::span<float> values) {
  const std::size_t each = form.allocated / 8;
  for (std::size_t v = 0; v < values.size(); ++v) {
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < each; ++b) {
      const std::size_t at = v * each + (big_endian ? b : each - 1 - b);
      word = word << 8u | static_cast<std::uint32_t>(bytes[at]);
    }
    values[v] = value_of(word, form);
  }
}

std::optional<DicomPadding> padding_of(const DicomFile& file, const DicomPixelForm& form) {
  const auto value = file.data.word(dicom_tag(0x28, 0x120));
  if (!value) return std::nullopt;
  const auto number = [&](std::uint16_t word) {
    return form.is_signed ? static_cast<float>(static_cast<std::int16_t>(word))
                          : static_cast<float>(word);
  };
  const float one = number(*value);
  const float other = number(file.data.word(dicom_tag(0x28, 0x121)).value_or(*value));
  return DicomPadding{std::min(one, other), std::max(one, other)};
}

void read_stored_frame(const DicomFile& file, const DicomPixelForm& form, std::uint32_t frame,
                       std::span<float> values) {
  const DicomElement& pixels = *file.data.find(kPixelData);
  const std::uint64_t bytes = form.frame_bytes();
  if (is_native(file.transfer_syntax)) {
    // Bytes in words of the other order lie in swapped pairs.
    const bool pairs = file.big_endian && form.allocated == 8 && pixels.vr == std::array{'O', 'W'};
    const std::uint64_t begin = bytes * frame;
    if (pairs) {
      // A pair may lie in two frames.
      for (std::size_t v = 0; v < values.size(); ++v) {
        const std::size_t at = (begin + v) ^ 1u;
        const auto byte = at < pixels.value.size() ? pixels.value[at] : std::byte{0};
        values[v] = value_of(static_cast<std::uint32_t>(byte), form);
      }
      return;
    }
    return take_plain(pixels.value.subspan(begin, bytes), form, file.big_endian, values);
  }
  const std::vector<std::byte> packed = packed_frame(file, pixels, form, frame);
  const std::string place = "PixelData, frame " + std::to_string(frame + 1);
  if (file.transfer_syntax == kPlain) {
    if (packed.size() < bytes || packed.size() > bytes + 1)
      refuse_length(file, packed.size(), bytes);
    return take_plain(packed, form, false, values);
  }
  const std::vector<std::int32_t> words = unpacked(file, form, packed);
  if (words.size() != values.size()) {
    throw InputError(
        file.path, place, "packed pixels that are damaged, or of another size",
        "a whole picture of " + std::to_string(form.columns) + " x " + std::to_string(form.rows));
  }
  std::ranges::transform(words, values.begin(), [&](std::int32_t word) {
    return value_of(static_cast<std::uint32_t>(word), form);
  });
}

}  // namespace

DicomPixelForm dicom_pixel_form(const DicomFile& file) {
  DicomPixelForm form;
  form.rows = needed_word(file, dicom_tag(0x28, 0x10), "Rows");
  form.columns = needed_word(file, dicom_tag(0x28, 0x11), "Columns");
  if (form.rows == 0 || form.columns == 0) {
    throw InputError(file.path, "Rows", "no pixels", "at least one");
  }
  if (const std::string frames = file.data.text(dicom_tag(0x28, 8)); !frames.empty()) {
    const auto count = number<std::uint32_t>(frames);
    constexpr std::uint32_t kMost = 1 << 24;
    if (!count || *count == 0 || *count > kMost) {
      throw InputError(file.path, "NumberOfFrames", frames, "at least 1");
    }
    form.frames = *count;
  }
  const std::uint16_t samples = file.data.word(dicom_tag(0x28, 2)).value_or(1);
  const std::string sense = file.data.text(dicom_tag(0x28, 4));
  if (samples != 1 || (!sense.empty() && sense != "MONOCHROME1" && sense != "MONOCHROME2")) {
    throw InputError(file.path, "PhotometricInterpretation",
                     sense + " of " + std::to_string(samples) + " samples",
                     "MONOCHROME1 or MONOCHROME2, one grey value a pixel");
  }
  form.allocated = needed_word(file, dicom_tag(0x28, 0x100), "BitsAllocated");
  if (form.allocated != 8 && form.allocated != 16 && form.allocated != 32) {
    throw InputError(file.path, "BitsAllocated", std::to_string(form.allocated), "8, 16 or 32");
  }
  form.stored = needed_word(file, dicom_tag(0x28, 0x101), "BitsStored");
  form.high_bit =
      file.data.word(dicom_tag(0x28, 0x102)).value_or(static_cast<std::uint16_t>(form.stored - 1));
  if (form.stored == 0 || form.high_bit >= form.allocated || form.high_bit + 1 < form.stored) {
    throw InputError(file.path, "BitsStored",
                     std::to_string(form.stored) + " below bit " + std::to_string(form.high_bit),
                     "bits within the " + std::to_string(form.allocated) + " of BitsAllocated");
  }
  const std::uint16_t sign = needed_word(file, dicom_tag(0x28, 0x103), "PixelRepresentation");
  if (sign > 1) throw InputError(file.path, "PixelRepresentation", std::to_string(sign), "0 or 1");
  form.is_signed = sign == 1;
  form.padding = padding_of(file, form);
  if (file.data.item(dicom_tag(0x28, 0x3000))) {
    throw InputError(file.path, "ModalityLUTSequence", "a table of grey values",
                     "RescaleSlope and RescaleIntercept");
  }

  const DicomElement* pixels = file.data.find(kPixelData);
  if (!pixels) throw InputError(file.path, "PixelData", "no such element", "one");
  const std::string& syntax = file.transfer_syntax;
  if (is_native(syntax)) {
    const std::uint64_t announced = form.frame_bytes() * form.frames;
    const std::uint64_t held = pixels->value.size();
    if (held < announced || held > announced + announced % 2) {
      refuse_length(file, held, announced);
    }
  } else if (!is_unpacked_here(syntax)) {
    throw InputError(file.path, "TransferSyntaxUID", syntax,
                     "plain, RLE, JPEG, JPEG-LS or JPEG 2000");
  } else if ((syntax == kJpeg || syntax == kJpegExtended) && form.stored > 8) {
    throw InputError(file.path, "BitsStored", std::to_string(form.stored) + " of lossy JPEG",
                     "8, or JPEG without loss");
  } else if (pixels->fragments.size() < std::size_t{form.frames} + 1) {
    throw InputError(
        file.path, "PixelData",
        std::to_string(pixels->fragments.size() - (pixels->fragments.empty() ? 0 : 1)) +
            " fragments",
        "at least one for each of " + std::to_string(form.frames) + " frames");
  }
  if (!is_native(syntax)) check_packed_size(file, *pixels, form);
  return form;
}

void read_dicom_frame(const DicomFile& file, const DicomPixelForm& form, std::uint32_t frame,
                      std::span<float> values) {
  read_stored_frame(file, form, frame, values);
  if (!form.padding) return;
  for (float& value : values) {
    if (value >= form.padding->least && value <= form.padding->most) {
      value = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

}  // namespace sulcus
