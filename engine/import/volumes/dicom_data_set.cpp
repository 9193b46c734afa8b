#include "engine/import/volumes/dicom_data_set.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/text_header.hpp"

namespace sulcus {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffff;
constexpr DicomTag kItem = dicom_tag(0xfffe, 0xe000), kItemEnd = dicom_tag(0xfffe, 0xe00d),
                   kSequenceEnd = dicom_tag(0xfffe, 0xe0dd);
constexpr std::size_t kPreamble = 128;
constexpr std::string_view kImplicit = "1.2.840.10008.1.2", kBig = "1.2.840.10008.1.2.2",
                           kDeflated = "1.2.840.10008.1.2.1.99";

std::string tag_text(DicomTag tag) {
  char text[16];
  std::snprintf(text, sizeof text, "(%04x,%04x)", tag >> 16u, tag & 0xffffu);
  return text;
}

/// Sequences that matter, for where a file does not say what its elements are.
bool is_known_sequence(DicomTag tag) {
  constexpr std::array kSequences{dicom_tag(0x5200, 0x9229), dicom_tag(0x5200, 0x9230),
                                  dicom_tag(0x0020, 0x9113), dicom_tag(0x0020, 0x9116),
                                  dicom_tag(0x0028, 0x9110), dicom_tag(0x0028, 0x9145),
                                  dicom_tag(0x0028, 0x3000)};
  return std::ranges::find(kSequences, tag) != kSequences.end();
}

bool has_long_length(std::array<char, 2> vr) {
  constexpr std::array<std::string_view, 12> kLong{"OB", "OD", "OF", "OL", "OV", "OW",
                                                   "SQ", "SV", "UC", "UN", "UR", "UT"};
  const std::string_view name(vr.data(), vr.size());
  return name == "UV" || std::ranges::find(kLong, name) != kLong.end();
}

/// Goes through encoded elements. Offsets are those of the whole file.
class Parser {
 public:
  /// How elements are written; explicit and little endian unless said.
  struct Syntax {
    bool implicit = false, big_endian = false;
  };
  Parser(const std::string& path, std::span<const std::byte> bytes, Syntax syntax)
      : path_(path), bytes_(bytes), implicit_(syntax.implicit), big_endian_(syntax.big_endian) {}

  /// Elements from `at` up to `end`, to the end of an item where that has no length, or to the
  /// pixels.
  DicomDataSet data_set(std::size_t& at, std::size_t end, bool until_item_ends, int depth) const {
    // Of a hand's file a dozen; a file that was made to may go on for ever.
    constexpr int kDeepest = 32;
    if (depth > kDeepest) throw InputError(path_, "data set", "sequences within others", "fewer");
    DicomDataSet data;
    data.set_big_endian(big_endian_);
    while (at < end) {
      if (until_item_ends && tag_at(at, end) == kItemEnd) {
        at += 8;
        return data;
      }
      DicomElement element = next(at, end, depth);
      const bool pixels = element.tag == kPixelData && depth == 0;
      data.add(std::move(element));
      if (pixels) return data;
    }
    if (until_item_ends) broken_off(kItem, at, end);
    return data;
  }

 private:
  [[noreturn]] void broken_off(DicomTag tag, std::size_t wanted, std::size_t held) const {
    throw InputError(path_, tag == kPixelData ? "PixelData" : tag_text(tag),
                     std::to_string(held) + " bytes", std::to_string(wanted) + ": it breaks off");
  }

  template <class Word>
  Word word_at(std::size_t at, std::size_t end) const {
    if (end - at < sizeof(Word)) {
      throw InputError(path_, "data set",
                       "an element that breaks off at byte " + std::to_string(at),
                       "a whole DICOM file");
    }
    std::array<std::byte, sizeof(Word)> raw;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), raw.size(), raw.begin());
    if (big_endian_) std::ranges::reverse(raw);
    Word word;
    std::memcpy(&word, raw.data(), raw.size());
    return word;
  }
  DicomTag tag_at(std::size_t at, std::size_t end) const {
    if (end - at < 4) (void)word_at<std::uint32_t>(at, end);
    return dicom_tag(word_at<std::uint16_t>(at, end), word_at<std::uint16_t>(at + 2, end));
  }

  DicomElement next(std::size_t& at, std::size_t end, int depth) const {
    DicomElement element;
    element.tag = tag_at(at, end);
    at += 4;
    std::uint32_t length = 0;
    bool implicit_items = implicit_;
    if (implicit_ || element.tag >> 16u == 0xfffe) {
      length = word_at<std::uint32_t>(at, end);
      at += 4;
      element.vr = {' ', ' '};
    } else {
      (void)word_at<std::uint16_t>(at, end);
      std::memcpy(element.vr.data(), bytes_.data() + at, 2);
      const auto capital = [](char c) { return c >= 'A' && c <= 'Z'; };
      if (!capital(element.vr[0]) || !capital(element.vr[1])) {
        throw InputError(path_, tag_text(element.tag), "no kind of value",
                         "two capital letters: it is damaged");
      }
      at += 2;
      if (has_long_length(element.vr)) {
        at += 2;
        if (at > end) at = end;
        length = word_at<std::uint32_t>(at, end);
        at += 4;
      } else {
        length = word_at<std::uint16_t>(at, end);
        at += 2;
      }
      // Of what its writer did not know, the elements within are implicit.
      implicit_items = element.vr == std::array{'U', 'N'};
    }
    const bool undefined = length == kUndefined;
    if (!undefined && length > end - at) broken_off(element.tag, length, end - at);
    if (element.tag == kPixelData && undefined) {
      read_fragments(at, end, element);
      return element;
    }
    const bool untold = implicit_ || implicit_items;
    const bool sequence = element.vr == std::array{'S', 'Q'} || undefined ||
                          (untold && is_known_sequence(element.tag));
    if (sequence) {
      const std::size_t sequence_end = undefined ? end : at + length;
      if (implicit_items == implicit_) {
        read_items(at, sequence_end, undefined, depth, element);
      } else {
        Parser(path_, bytes_, {.implicit = true})
            .read_items(at, sequence_end, undefined, depth, element);
      }
      return element;
    }
    element.value = bytes_.subspan(at, length);
    at += length;
    return element;
  }

  void read_items(std::size_t& at, std::size_t end, bool undefined, int depth,
                  DicomElement& sequence) const {
    while (at < end) {
      const DicomTag tag = tag_at(at, end);
      const auto length = word_at<std::uint32_t>(at + 4, end);
      at += 8;
      if (tag == kSequenceEnd && undefined) return;
      if (tag != kItem) {
        throw InputError(path_, tag_text(sequence.tag), tag_text(tag), "items of a sequence");
      }
      const bool open = length == kUndefined;
      if (!open && length > end - at) broken_off(sequence.tag, length, end - at);
      const std::size_t item_end = open ? end : at + length;
      sequence.items.push_back(data_set(at, item_end, open, depth + 1));
      if (!open) at = item_end;
    }
    if (undefined) broken_off(sequence.tag, end + 8, end);
  }

  void read_fragments(std::size_t& at, std::size_t end, DicomElement& pixels) const {
    while (true) {
      if (end - at < 8) broken_off(kPixelData, at + 8, end);
      const DicomTag tag = tag_at(at, end);
      const auto length = word_at<std::uint32_t>(at + 4, end);
      at += 8;
      if (tag == kSequenceEnd) return;
      if (tag != kItem) throw InputError(path_, "PixelData", tag_text(tag), "fragments");
      if (length > end - at) broken_off(kPixelData, length, end - at);
      pixels.fragments.push_back(bytes_.subspan(at, length));
      at += length;
    }
  }

  const std::string& path_;
  std::span<const std::byte> bytes_;
  bool implicit_, big_endian_;
};

/// Whether a data set that may go on is there up to the end of its pixels.
bool holds_pixels(const std::string& path, std::span<const std::byte> bytes) {
  try {
    std::size_t at = 0;
    return Parser(path, bytes, {}).data_set(at, bytes.size(), false, 0).find(kPixelData) != nullptr;
  } catch (const InputError&) {
    return false;  // it breaks off, or is damaged, which is told of the whole
  }
}

/// As far as its pixels: what follows them is not read, and may be without end.
std::vector<std::byte> inflated_data_set(const std::string& path, std::span<const std::byte> packed,
                                         std::uint64_t most_bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  std::vector<std::byte> out;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  int status = Z_OK;
  bool pixels = false;
  std::size_t looked_at_next = 0;
  while (status == Z_OK && !pixels && out.size() < most_bytes) {
    constexpr std::size_t kBlock = std::size_t{1} << 20;
    const std::size_t held = out.size();
    out.resize(held + kBlock);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + held);
    stream.avail_out = static_cast<uInt>(kBlock);
    status = inflate(&stream, Z_NO_FLUSH);
    out.resize(held + kBlock - stream.avail_out);
    if (out.size() < looked_at_next) continue;
    pixels = holds_pixels(path, out);
    looked_at_next = 2 * out.size();  // so that looking stays the smaller part
  }
  inflateEnd(&stream);
  if (status == Z_OK && !pixels) pixels = holds_pixels(path, out);
  if (pixels || status == Z_STREAM_END) return out;
  throw InputError(path, "data set", "a deflate stream that is damaged, or too long",
                   "a whole one");
}

std::vector<std::byte> bytes_of(const std::string& path, std::uint64_t most_bytes) {
  const std::uint64_t size = std::filesystem::file_size(path);
  if (size > most_bytes) {
    throw InputError(path, "", std::to_string(size) + " bytes",
                     "at most " + std::to_string(most_bytes) + " (--limit-gib)");
  }
  std::vector<std::byte> bytes(size);
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::uint64_t>(in.gcount()) != size) {
    throw InputError(path, "", "no readable file", "a DICOM file");
  }
  return bytes;
}

bool begins_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

/// Files of before there was a preamble begin with an element of group 2 or 8.
bool begins_with_element(std::span<const std::byte> bytes) {
  return begins_with(bytes, std::string_view("\2\0\0\0", 4)) ||
         begins_with(bytes, std::string_view("\2\0\2\0", 4)) ||
         begins_with(bytes, std::string_view("\10\0\0\0", 4)) ||
         begins_with(bytes, std::string_view("\10\0\5\0", 4)) ||
         begins_with(bytes, std::string_view("\10\0\10\0", 4)) ||
         begins_with(bytes, std::string_view("\10\0\26\0", 4));
}

}  // namespace

const DicomElement* DicomDataSet::find(DicomTag tag) const {
  const auto found = std::ranges::find(elements_, tag, &DicomElement::tag);
  return found == elements_.end() ? nullptr : &*found;
}

const DicomDataSet* DicomDataSet::item(DicomTag sequence, std::size_t index) const {
  const DicomElement* element = find(sequence);
  return element && index < element->items.size() ? &element->items[index] : nullptr;
}

std::string DicomDataSet::text(DicomTag tag) const {
  const DicomElement* element = find(tag);
  if (!element) return {};
  std::string text(reinterpret_cast<const char*>(element->value.data()), element->value.size());
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return trimmed(text);
}

std::vector<double> DicomDataSet::decimals(DicomTag tag) const {
  const std::string text = this->text(tag);
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\\', begin), text.size());
    const auto value = number<double>(trimmed(std::string_view(text).substr(begin, end - begin)));
    if (!value) return {};
    numbers.push_back(*value);
    begin = end + 1;
  }
  return numbers;
}

std::optional<std::uint16_t> DicomDataSet::word(DicomTag tag) const {
  const DicomElement* element = find(tag);
  if (!element || element->value.size() != 2) return std::nullopt;
  const auto low = static_cast<unsigned>(element->value[big_endian_ ? 1 : 0]);
  const auto high = static_cast<unsigned>(element->value[big_endian_ ? 0 : 1]);
  return static_cast<std::uint16_t>(high << 8u | low);
}

bool is_dicom(const std::string& path) {
  std::array<std::byte, kPreamble + 4> begin{};
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(begin.data()), begin.size());
  const auto held = std::span<const std::byte>(begin).first(static_cast<std::size_t>(in.gcount()));
  return (held.size() == begin.size() && begins_with(held.subspan(kPreamble), "DICM")) ||
         begins_with_element(held);
}

DicomFile read_dicom_file(const std::string& path, std::uint64_t most_bytes) {
  DicomFile file{
      .path = path, .transfer_syntax = {}, .bytes = bytes_of(path, most_bytes), .data = {}};
  const std::span<const std::byte> all(file.bytes);
  std::size_t at = 0;
  if (all.size() >= kPreamble + 4 && begins_with(all.subspan(kPreamble), "DICM")) {
    at = kPreamble + 4;
  } else if (!begins_with_element(all)) {
    throw InputError(path, "header", "contents that cannot be one", "a DICOM file");
  }
  // Group 2 says how the rest is written, and is always explicit and little endian itself.
  std::size_t meta_end = at;
  while (meta_end + 8 <= all.size() && all[meta_end] == std::byte{2} &&
         all[meta_end + 1] == std::byte{0}) {
    std::size_t length = 8;
    const std::array vr{static_cast<char>(all[meta_end + 4]), static_cast<char>(all[meta_end + 5])};
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(all[meta_end + i]); };
    if (!has_long_length(vr)) {
      length += byte(6) | byte(7) << 8u;
    } else if (meta_end + 12 <= all.size()) {
      length = 12 + (byte(8) | byte(9) << 8u | byte(10) << 16u | byte(11) << 24u);
    }
    if (length > all.size() - meta_end) {
      throw InputError(path, "header", "elements that break off", "a whole DICOM file");
    }
    meta_end += length;
  }
  const DicomDataSet meta = Parser(path, all, {}).data_set(at, meta_end, false, 0);
  constexpr DicomTag kTransferSyntax = dicom_tag(2, 0x10);
  file.transfer_syntax = meta.text(kTransferSyntax);
  if (file.transfer_syntax.empty()) {
    // Without a group 2: implicit, unless what should be a length spells a kind of value.
    const auto capital = [&](std::size_t i) {
      return i < all.size() && all[i] >= std::byte{'A'} && all[i] <= std::byte{'Z'};
    };
    file.transfer_syntax =
        capital(at + 4) && capital(at + 5) ? "1.2.840.10008.1.2.1" : std::string(kImplicit);
  }
  file.big_endian = file.transfer_syntax == kBig;
  if (file.transfer_syntax == kDeflated) {
    file.bytes = inflated_data_set(path, all.subspan(at), most_bytes);
    at = 0;
  }
  const std::span<const std::byte> rest(file.bytes);
  file.data = Parser(file.path, rest,
                     {.implicit = file.transfer_syntax == kImplicit, .big_endian = file.big_endian})
                  .data_set(at, rest.size(), false, 0);
  return file;
}

}  // namespace sulcus
