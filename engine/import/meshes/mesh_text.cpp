#include "engine/import/meshes/mesh_text.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include "engine/core/error.hpp"

namespace sulcus {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

}  // namespace

MeshText::MeshText(std::string_view text, std::size_t at, std::uint64_t line)
    : text_(at == 0 ? without_byte_order_mark(text) : text), at_(at), line_(line) {}

void MeshText::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

bool MeshText::end_line() {
  if (at_ == text_.size() || !is_line_end(text_[at_])) return false;
  at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
  ++line_;
  return true;
}

std::string_view MeshText::word_of_line() {
  skip_blanks();
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && !is_line_end(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view MeshText::word() {
  do {
    if (const std::string_view word = word_of_line(); !word.empty()) return word;
  } while (end_line());
  return {};
}

void MeshText::skip_line() {
  while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
}

bool MeshText::next_line() {
  skip_line();
  while (end_line()) {
    if (!at_line_end()) return true;
  }
  return false;
}

bool MeshText::at_line_end() {
  skip_blanks();
  return at_ == text_.size() || is_line_end(text_[at_]);
}

std::string MeshText::found(std::string_view word) const {
  if (!word.empty()) return std::string("'").append(word).append("'");
  return at_ == text_.size() ? "the end of the file" : "the end of the line";
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::optional<double> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);  // from_chars knows none
  const char* end = word.data() + word.size();
  double value = 0.0;
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (rest != end || word.starts_with('+')) return std::nullopt;
  if (error == std::errc{}) return value;
  if (error != std::errc::result_out_of_range) return std::nullopt;
  // So short a word can only be out of range by its exponent.
  if (word.size() > 64) return std::nullopt;
  const bool small = word.find("e-") != word.npos || word.find("E-") != word.npos;
  return small ? 0.0 : std::numeric_limits<double>::infinity();
}

std::optional<std::int64_t> parse_whole_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* end = word.data() + word.size();
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (rest != end || error != std::errc{}) return std::nullopt;
  return value;
}

std::string read_mesh_bytes(const std::string& path, const InputLimits& limits) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (!in || error) throw InputError(path, "", "no readable file", "a mesh");
  const std::uint64_t most = limits.memory_bytes / 4;
  if (bytes > most) {
    throw InputError(path, "", std::to_string(bytes) + " bytes",
                     "at most " + std::to_string(most) + " (--limit-gib)");
  }
  std::string contents(bytes, '\0');
  in.read(contents.data(), static_cast<std::streamsize>(contents.size()));
  contents.resize(static_cast<std::size_t>(in.gcount()));
  return contents;
}

}  // namespace sulcus
