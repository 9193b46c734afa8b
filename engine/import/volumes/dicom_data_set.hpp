#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sulcus {

/// Group and element of a DICOM data element.
using DicomTag = std::uint32_t;
constexpr DicomTag dicom_tag(unsigned group, unsigned element) { return group << 16u | element; }
inline constexpr DicomTag kPixelData = dicom_tag(0x7fe0, 0x0010);

class DicomDataSet;

/// A data element of a file that is held in memory.
struct DicomElement {
  DicomTag tag = 0;
  std::array<char, 2> vr{};                           // blanks where the file does not say
  std::span<const std::byte> value;                   // of a plain element
  std::vector<DicomDataSet> items;                    // of a sequence
  std::vector<std::span<const std::byte>> fragments;  // of packed pixels; the first: their offsets
};

/// Data elements [DICOM PS3.5, 7]. Values are numbers where they are written as such.
class DicomDataSet {
 public:
  void set_big_endian(bool big_endian) { big_endian_ = big_endian; }
  void add(DicomElement element) { elements_.push_back(std::move(element)); }

  /// Null: there is none.
  const DicomElement* find(DicomTag tag) const;
  /// The first item of a sequence; null: there is none.
  const DicomDataSet* item(DicomTag sequence, std::size_t index = 0) const;
  /// Without the blanks that fill it up; empty where there is none.
  std::string text(DicomTag tag) const;
  /// Numbers in text with backslashes between them (DS, IS); none: no such element, or something
  /// else in it.
  std::vector<double> decimals(DicomTag tag) const;
  /// A number of 16 bits (US).
  std::optional<std::uint16_t> word(DicomTag tag) const;

 private:
  std::vector<DicomElement> elements_;
  bool big_endian_ = false;
};

/// A DICOM file.
struct DicomFile {
  std::string path, transfer_syntax;
  std::vector<std::byte> bytes;  // what the elements point into
  DicomDataSet data;
  bool big_endian = false;
};

/// Whether a file begins as DICOM files do.
bool is_dicom(const std::string& path);

/// Reads the data elements of a file up to its pixels [DICOM PS3.5, PS3.10]: implicit and explicit,
/// little and big endian, deflated. What pixels are packed by does not matter here.
/// @throws InputError: not DICOM, broken off, an element longer than what holds it, larger than
/// `most_bytes`.
DicomFile read_dicom_file(const std::string& path, std::uint64_t most_bytes);

}  // namespace sulcus
