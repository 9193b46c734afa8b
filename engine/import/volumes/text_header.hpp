#pragma once

#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sulcus {

/// The words of a text, with blanks between them.
std::vector<std::string> words(const std::string& text);

/// The whole of `text` as a number.
template <class Number>
std::optional<Number> number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Whole numbers of a field. @throws InputError: something else.
std::vector<std::int64_t> whole_numbers(const std::string& path, const std::string& place,
                                        const std::string& text);
/// As many finite numbers as `count`. @throws InputError: something else, or another count.
std::vector<double> finite_numbers(const std::string& path, const std::string& place,
                                   const std::string& text, std::size_t count);

/// "field: value" or "field = value", a line each, as NRRD and MetaImage begin.
struct TextHeader {
  explicit TextHeader(std::string file) : path(std::move(file)) {}

  std::string path;
  std::map<std::string, std::string> fields;  // keys in lower case
  std::vector<std::string> behind;            // lines behind a field that begins a list of files
  std::uint64_t bytes = 0;                    // up to and with the line that ends it

  bool has(const std::string& key) const { return fields.contains(key); }
  /// Empty where there is none.
  const std::string& at(const std::string& key) const;
  /// @throws InputError: no such field.
  const std::string& need(const std::string& key) const;
};

/// A field by its key, and by its name in the format, for messages.
struct HeaderField {
  std::string key, name;
};

/// The sizes of the axes. @throws InputError: not as many as `dimension` says.
std::vector<std::int64_t> sizes_of(const TextHeader& header, const HeaderField& sizes,
                                   const HeaderField& dimension);

/// Lines until an empty one. `key := value` is a note of the user's. @throws InputError: no header
/// that ends, a field twice.
TextHeader read_nrrd_text(const std::string& path);
/// Lines until ElementDataFile. @throws InputError: the same, or a field behind that.
TextHeader read_meta_image_text(const std::string& path);

/// The files that a header names for its data: one, or the lines behind LIST, or a pattern like
/// "slice%03d.raw 1 20 1". `place`: the field, for messages. @throws InputError: none there, a
/// pattern that is none, a file that is not there.
std::vector<std::string> data_files(const TextHeader& header, const std::string& key,
                                    const std::string& place);

/// Of so many values, those in each of so many files. @throws InputError: they do not part evenly.
std::size_t values_per_file(const TextHeader& header, const std::string& place,
                            std::uint64_t values, std::size_t files);

}  // namespace sulcus
