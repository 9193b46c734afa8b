#include "engine/core/user_text.hpp"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include "tests/support/scratch_folder.hpp"

namespace sulcus::user_text_test {
namespace {

/// What each language takes for its own, by itself and in a word.
const std::vector<std::string>& hostile_texts() {
  static const std::vector<std::string> texts{
      "",
      " ",
      "plain-name_1.nrrd",
      "`touch found`",
      "\"`touch found`\"",
      "'; system(\"touch found\"); '",
      "' . system('touch found') . '",
      "a\nsystem \"touch found\"\nb",
      "!touch found",
      "@found $(touch found) ${HOME} $HOME",
      "a'b''c'''",
      "\\",
      "a\\",
      "a\\'",
      "a\\\"; b",
      "# comment",
      "-option",
      "~root",
      "a;touch found&touch found|cat>found",
      "*?[a]{b,c}!",
      "%s%n {= system 'touch found' =}",
      "<script>alert(1)</script> & \" onload='x'",
      "]]> --> </title>",
      "\x1b]0;found\x07\x1b[2J",
      "tab\tfeed\f return\r bell\a",
      "umlauts \xc3\xa4\xc3\xb6, \xe6\xad\xaf",
      "C1 \xc2\x9b"
      "31m right to left \xe2\x80\xaegnp isolate \xe2\x81\xa6 line \xe2\x80\xa8.",
      "no UTF-8: \xff \xc3 \xe2\x80",
      "overlong \xe0\x80\x9b[2J",
  };
  return texts;
}

std::string output_of(const std::string& command) {
  std::string out;
  std::FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer{};
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    out.append(buffer.data(), n);
  }
  pclose(pipe);
  return out;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

std::string with_blanks(std::string text) {
  for (char& c : text) c = is_control(c) ? ' ' : c;
  return text;
}

TEST(ForShell, BashMakesTheSameBytesOfIt) {
  const ScratchFolder scratch;
  for (const std::string& text : hostile_texts()) {
    const std::string word = for_shell(text);
    EXPECT_EQ(word, with_blanks(word)) << "more than one line: " << word;
    const std::string script = scratch.write("script", "printf %s. " + word + "\n");
    EXPECT_EQ(output_of("cd " + scratch.path("") + " && bash script"), text + ".") << word;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch.path("found")));
  EXPECT_EQ(for_shell("scans/a.nrrd"), "scans/a.nrrd");
  EXPECT_EQ(for_shell("it's"), "'it'\\''s'");
}

TEST(ForGnuplot, ItPrintsTheTextAndRunsNothing) {
  const ScratchFolder scratch;
  std::string script, expected;
  for (const std::string& text : hostile_texts()) {
    script += "print " + for_gnuplot(text) + "\n";
    expected += with_blanks(text) + "\n";
  }
  scratch.write("script", script);
  EXPECT_EQ(output_of("cd " + scratch.path("") + " && gnuplot -d script 2>&1"), expected);
  EXPECT_FALSE(std::filesystem::exists(scratch.path("found")));
}

TEST(ForToml, ReadsAsTheSameText) {
  for (const std::string& text : hostile_texts()) {
    if (for_terminal(text).find('?') != std::string::npos && text.find('?') == std::string::npos) {
      continue;  // TOML holds UTF-8 alone
    }
    const toml::table table = toml::parse("value = " + for_toml(text) + "\nother = 1\n");
    EXPECT_EQ(table["value"].value<std::string>(), text);
    EXPECT_EQ(table.size(), 2u);
  }
}

TEST(ForHtml, HasNoTagNoEndOfAnAttributeAndNoControl) {
  for (const std::string& text : hostile_texts()) {
    const std::string safe = for_html(text);
    EXPECT_EQ(safe.find_first_of("<>\"'"), std::string::npos) << safe;
    for (const char c : safe) EXPECT_TRUE(!is_control(c) || c == '\t' || c == '\n') << safe;
  }
  EXPECT_EQ(for_html("a & <b> \"c\" 'd'"), "a &amp; &lt;b&gt; &quot;c&quot; &#39;d&#39;");
}

TEST(ForTerminal, IsOneLineThatActsOnNothing) {
  EXPECT_EQ(for_terminal("a\nb\x1b[2J\x7f"), "a b [2J ");
  EXPECT_EQ(for_terminal("\xc3\xa4 \xe6\xad\xaf \xf0\x9f\xa6\xb7"),
            "\xc3\xa4 \xe6\xad\xaf \xf0\x9f\xa6\xb7");
  EXPECT_EQ(for_terminal("a\xc2\x9b"
                         "31m"),
            "a 31m");
  EXPECT_EQ(for_terminal("a\xe2\x80\xaegnp.exe"), "a gnp.exe");
  EXPECT_EQ(for_terminal("\xe2\x81\xa6x\xe2\x81\xa9\xe2\x80\xa8"), " x  ");
  EXPECT_EQ(for_terminal("\xe2\x80\x94\xe2\x81\x84"),
            "\xe2\x80\x94\xe2\x81\x84");  // a dash, a slash
  EXPECT_EQ(for_terminal("a\x9b"
                         "2J"),
            "a?2J");
  EXPECT_EQ(for_terminal("\xe0\x80\x9b\xc1\xbf\xf4\x90\x80\x80"), "?????????");
}

}  // namespace
}  // namespace sulcus::user_text_test
