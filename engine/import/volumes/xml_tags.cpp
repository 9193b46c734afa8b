#include "engine/import/volumes/xml_tags.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

namespace sulcus {
namespace {

constexpr std::string_view kXmlBlanks = " \t\r\n";

bool is_xml_blank(char c) { return kXmlBlanks.find(c) != std::string_view::npos; }

/// A character by its number, as UTF-8; empty: there is none of that number.
std::string utf8(std::uint32_t code) {
  constexpr std::uint32_t kLast = 0x10ffff;
  if (code == 0 || code > kLast) return {};
  if (code < 0x80) return {static_cast<char>(code)};
  const auto low = [&](unsigned bits) { return static_cast<char>(0x80u | (code >> bits & 0x3fu)); };
  if (code < 0x800) return {static_cast<char>(0xc0u | code >> 6u), low(0)};
  if (code < 0x10000) return {static_cast<char>(0xe0u | code >> 12u), low(6), low(0)};
  return {static_cast<char>(0xf0u | code >> 18u), low(12), low(6), low(0)};
}

/// What stands between & and ; says; empty: not known.
std::string referred(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kNamed{
      {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}}};
  for (const auto& [known, character] : kNamed) {
    if (name == known) return {character};
  }
  if (!name.starts_with('#')) return {};
  name.remove_prefix(1);
  const bool hexadecimal = name.starts_with('x');
  if (hexadecimal) name.remove_prefix(1);
  std::uint32_t code = 0;
  const auto [end, error] =
      std::from_chars(name.data(), name.data() + name.size(), code, hexadecimal ? 16 : 10);
  return error == std::errc{} && end == name.data() + name.size() ? utf8(code) : std::string();
}

std::string attribute_value(std::string_view raw) {
  std::string value;
  for (std::size_t at = 0; at < raw.size(); ++at) {
    if (is_xml_blank(raw[at])) {
      value += ' ';
      continue;
    }
    const std::size_t end = raw[at] == '&' ? raw.find(';', at) : std::string_view::npos;
    const std::string character =
        end == std::string_view::npos ? "" : referred(raw.substr(at + 1, end - at - 1));
    value += character.empty() ? std::string(1, raw[at]) : character;
    if (!character.empty()) at = end;
  }
  return value;
}

/// Goes through a text; each step gives false where that breaks off.
class XmlScanner {
 public:
  explicit XmlScanner(std::string_view text) : text_(text) {}

  /// To the next tag that opens an element; `found` is empty at the end of the text.
  bool next(std::optional<XmlTag>& found) {
    found.reset();
    while ((at_ = std::min(text_.find('<', at_), text_.size())) < text_.size()) {
      if (begins("<!--")) {
        if (!go_behind("-->")) return false;
      } else if (begins("<![CDATA[")) {
        if (!go_behind("]]>")) return false;
      } else if (begins("<?")) {
        if (!go_behind("?>")) return false;
      } else if (begins("</") || begins("<!")) {
        if (!go_behind(">")) return false;
      } else {
        ++at_;
        return read_tag(found.emplace());
      }
    }
    return true;
  }

 private:
  bool begins(std::string_view with) const { return text_.substr(at_).starts_with(with); }
  bool go_behind(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) return false;
    at_ = found + end.size();
    return true;
  }
  void skip_blanks() { at_ = std::min(text_.find_first_not_of(kXmlBlanks, at_), text_.size()); }
  std::string_view name() {
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(" \t\r\n=/><\"'", at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

  bool read_tag(XmlTag& tag) {
    const std::string_view full = name();
    const std::size_t colon = full.find(':');
    tag.name = full.substr(colon == std::string_view::npos ? 0 : colon + 1);
    if (tag.name.empty()) return false;
    while (true) {
      skip_blanks();
      if (at_ == text_.size()) return false;
      if (text_[at_] == '/') ++at_;
      if (at_ < text_.size() && text_[at_] == '>') {
        ++at_;
        return true;
      }
      const std::string attribute(name());
      skip_blanks();
      if (attribute.empty() || !begins("=")) return false;
      ++at_;
      skip_blanks();
      if (!begins("\"") && !begins("'")) return false;
      const std::size_t begin = at_ + 1, end = text_.find(text_[at_], begin);
      if (end == std::string_view::npos) return false;
      tag.attributes.try_emplace(attribute, attribute_value(text_.substr(begin, end - begin)));
      at_ = end + 1;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

XmlTags xml_tags(std::string_view text) {
  XmlTags result;
  XmlScanner scanner(text);
  std::optional<XmlTag> tag;
  while ((result.whole = scanner.next(tag)) && tag) result.tags.push_back(std::move(*tag));
  return result;
}

}  // namespace sulcus
