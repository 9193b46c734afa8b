// What user_text.hpp makes of a text is read back by plain readers of each language, written here
// from its rules.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/user_text.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/toml_table.hpp"
#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

namespace sulcus::fuzz {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

std::string with_blanks(std::string_view text, std::string_view kept = "") {
  std::string blank(text);
  for (char& c : blank) {
    if (is_control(c) && kept.find(c) == std::string_view::npos) c = ' ';
  }
  return blank;
}

/// Characters of UTF-8, by the bits of its table; nothing where it is none.
std::optional<std::vector<char32_t>> characters(std::string_view text) {
  std::vector<char32_t> all;
  for (std::size_t at = 0; at < text.size();) {
    const auto lead = static_cast<unsigned char>(text[at++]);
    int more = 0;
    char32_t value = lead, least = 0;
    if (lead >= 0x80) {
      if (lead >> 5 == 0x6) {
        more = 1, value = lead & 0x1fu, least = 0x80;
      } else if (lead >> 4 == 0xe) {
        more = 2, value = lead & 0x0fu, least = 0x800;
      } else if (lead >> 3 == 0x1e) {
        more = 3, value = lead & 0x07u, least = 0x10000;
      } else {
        return {};
      }
    }
    for (; more > 0; --more) {
      if (at == text.size() || (static_cast<unsigned char>(text[at]) & 0xc0u) != 0x80u) return {};
      value = value << 6 | (static_cast<unsigned char>(text[at++]) & 0x3fu);
    }
    if (value < least || value > 0x10ffff || (value >= 0xd800 && value <= 0xdfff)) return {};
    all.push_back(value);
  }
  return all;
}

void check_terminal(const std::string& text) {
  const std::string line = for_terminal(text);
  const auto all = characters(line);
  expect(all.has_value(), "a terminal's line is no UTF-8");
  for (const char32_t c : *all) {
    const bool acts = c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x200e || c == 0x200f ||
                      (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
    expect(!acts, "a character that acts on the terminal: " + std::to_string(c));
  }
  expect(for_terminal(line) == line, "a line is not as a terminal takes it the second time");
}

void check_gnuplot(const std::string& text) {
  const std::string quoted = for_gnuplot(text);
  expect(quoted.size() >= 2 && quoted.front() == '"' && quoted.back() == '"', "no quotes");
  std::string read;
  for (std::size_t at = 1; at + 1 < quoted.size(); ++at) {
    if (quoted[at] != '\\') {
      expect(std::string_view("\"'`@$#%{}!").find(quoted[at]) == std::string_view::npos,
             "a character of gnuplot's");
      read += quoted[at];
      continue;
    }
    expect(at + 4 < quoted.size(), "no octal");
    read += static_cast<char>(std::stoi(quoted.substr(at + 1, 3), nullptr, 8));
    at += 3;
  }
  expect(read == with_blanks(text), "gnuplot reads another text");
}

void check_html(const std::string& text) {
  const std::string safe = for_html(text);
  expect(safe.find_first_of("<>\"'") == std::string::npos, "HTML of ours in a text");
  std::string read;
  for (std::size_t at = 0; at < safe.size(); ++at) {
    if (safe[at] != '&') {
      read += safe[at];
      continue;
    }
    const std::size_t end = safe.find(';', at);
    expect(end != std::string::npos, "an & that stands for nothing");
    const std::string name = safe.substr(at, end - at + 1);
    constexpr std::string_view kCharacters = "&<>\"'";
    const std::vector<std::string> names{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    std::size_t n = 0;
    while (n < names.size() && names[n] != name) ++n;
    expect(n < names.size(), "an unknown character: " + name);
    read += kCharacters[n];
    at = end;
  }
  expect(read == with_blanks(text, "\t\n"), "HTML reads another text");
}

/// The words that a shell makes of a line: quoted parts, $'...' with octals, and what needs no
/// quotes.
std::string shell_word(const std::string& line) {
  std::string read;
  for (std::size_t at = 0; at < line.size();) {
    const std::string_view rest = std::string_view(line).substr(at);
    if (rest.starts_with("$'")) {
      for (at += 2; at < line.size() && line[at] != '\'';) {
        expect(line[at] == '\\' && at + 3 < line.size(), "no octal in $''");
        read += static_cast<char>(std::stoi(line.substr(at + 1, 3), nullptr, 8));
        at += 4;
      }
      expect(at < line.size(), "$'' without an end");
      ++at;
    } else if (rest.starts_with("'")) {
      const std::size_t end = line.find('\'', at + 1);
      expect(end != std::string::npos, "a quote without an end");
      read += line.substr(at + 1, end - at - 1);
      at = end + 1;
    } else if (rest.starts_with("\\'")) {
      read += '\'';
      at += 2;
    } else {
      expect(rest.find_first_of("|&;<>()$`\\\"' \t\n*?[]#~%!{}") != 0,
             "a character of the shell's");
      read += line[at++];
    }
  }
  return read;
}

void check_shell(const std::string& text) {
  const std::string word = for_shell(text);
  expect(!word.empty() && with_blanks(word) == word, "no word on one line");
  expect(shell_word(word) == text, "a shell reads another text");
}

void check_toml(const std::string& text) {
  const auto all = characters(text);
  if (!all || text.find('\0') != std::string::npos) return;
  const toml::table table = toml::parse("value = " + for_toml(text) + "\n[other]\n");
  expect(table["value"].value<std::string>() == text && table.size() == 2,
         "TOML reads another text");
  toml::table scene;
  apply_override(scene, string_override("workpiece.file", text));
  expect(scene["workpiece"]["file"].value<std::string>() == text, "--set takes another text");
}

}  // namespace

void fuzz_text(Bytes bytes) {
  const std::string text(bytes.begin(), bytes.end());
  check_terminal(text);
  check_gnuplot(text);
  check_html(text);
  check_shell(text);
  check_toml(text);
}

}  // namespace sulcus::fuzz
