#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/documented_commands.hpp"

// What the house rules (tools/README.md) say of the tree as a whole: its top level, lengths of
// files, the words of messages, and that what the READMEs point at is there.

namespace sulcus::house_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = SULCUS_SOURCE_DIR;

std::vector<std::string> lines_of(const fs::path& file) {
  std::istringstream in(test::read_file(file.string()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Every file below folders of the root.
std::vector<fs::path> files_below(std::initializer_list<const char*> folders) {
  std::vector<fs::path> files;
  for (const char* folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const bool made = entry.path().string().find("__pycache__") != std::string::npos;
      if (entry.is_regular_file() && !made) files.push_back(entry.path());
    }
  }
  return files;
}

std::string name_of(const fs::path& file) { return fs::relative(file, kRoot).generic_string(); }

TEST(House, TheTopLevelIsThis) {
  const std::set<std::string> allowed{
      "CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "app",  "assets",
      "engine",         "haptics",           "scenes",  "tests",     "tools"};
  const std::vector<std::string> ignored = lines_of(kRoot / ".gitignore");  // "/build/"
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || std::ranges::count(ignored, "/" + name + "/") > 0) continue;
    found.insert(name);
  }
  EXPECT_EQ(found, allowed);
}

TEST(House, TheReadmeIsShort) { EXPECT_LE(lines_of(kRoot / "README.md").size(), 150u); }

TEST(House, NoSourceIsLong) {
  const std::set<std::string> sources{".cpp", ".hpp", ".inl", ".in", ".c", ".h", ".py", ".gp", ""};
  int count = 0;
  for (const fs::path& file : files_below({"app", "engine", "haptics", "tools", "tests"})) {
    const bool data = name_of(file).starts_with("tests/fuzz/") && file.extension() != ".cpp";
    if (data || !sources.contains(file.extension().string())) continue;
    EXPECT_LE(lines_of(file).size(), 500u) << name_of(file);
    ++count;
  }
  EXPECT_GT(count, 500);
}

// --- Words --------------------------------------------------------------------------------------

/// The string literals of a C++ source, those beside each other as one. What is included is none.
std::vector<std::string> literals_of(const std::string& text) {
  std::vector<std::string> literals;
  bool goes_on = false;  // nothing but space since the last one
  const auto add = [&](const std::string& more) {
    if (!goes_on) literals.emplace_back();
    literals.back() += more;
    goes_on = true;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const std::string_view rest = std::string_view(text).substr(i);
    if (rest.starts_with("//") || rest.starts_with("#include")) {
      i = std::min(text.find('\n', i), text.size());
    } else if (rest.starts_with("/*")) {
      i = text.find("*/", i) + 1;
    } else if (rest.starts_with("R\"")) {
      const std::size_t open = text.find('(', i);
      const std::string close = ")" + text.substr(i + 2, open - i - 2) + "\"";
      const std::size_t end = text.find(close, open);
      add(text.substr(open + 1, end - open - 1));
      i = end + close.size() - 1;
    } else if (c == '"' ||
               (c == '\'' && (i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]))))) {
      std::string literal;
      for (++i; i < text.size() && text[i] != c; ++i) {
        literal += text[i] == '\\' ? ' ' : text[i];
        if (text[i] == '\\') ++i;
      }
      if (c == '"')
        add(literal);
      else
        goes_on = false;
    } else if (!std::isspace(static_cast<unsigned char>(c))) {
      goes_on = false;
    }
  }
  return literals;
}

TEST(House, LiteralsAreFound) {
  EXPECT_EQ(literals_of("#include \"a\"\n// \"b\"\nf(\"c \\\"d\"  \n \"e\", '\"', 1'0, "
                        "R\"x(\"g\")x\") /* \"h\" */"),
            (std::vector<std::string>{"c  de", "\"g\""}));
}

constexpr std::string_view kGlossary = "## Glossary";  // in haptics/README.md

/// The last column of the glossary, but what it marks as a word of code alone.
std::vector<std::string> replaced_words() {
  std::vector<std::string> words;
  bool in_glossary = false;
  for (const std::string& line : lines_of(kRoot / "haptics/README.md")) {
    if (line.starts_with("#")) in_glossary = line == kGlossary;
    if (!in_glossary || !line.starts_with("| ") || !line.ends_with(" |")) continue;
    const std::size_t last = line.rfind('|', line.size() - 2) + 1;
    std::istringstream cell(line.substr(last, line.size() - 1 - last));
    for (std::string word; std::getline(cell, word, ',');) {
      word.erase(0, word.find_first_not_of(' '));
      word.erase(word.find_last_not_of(' ') + 1);
      if (!word.empty() && !word.ends_with("(in code)") && word != "instead of") {
        words.push_back(word);
      }
    }
  }
  return words;
}

TEST(House, MessagesUseTheWordsOfTheGlossary) {
  const std::vector<std::string> words = replaced_words();
  ASSERT_GE(words.size(), 12u);
  std::string either;
  for (const std::string& word : words) either += (either.empty() ? "" : "|") + word;
  const std::regex pattern("\\b(" + either + ")\\b", std::regex::icase);
  const auto check = [&](const fs::path& file, const std::string& text) {
    std::smatch match;
    EXPECT_FALSE(std::regex_search(text, match, pattern))
        << name_of(file) << ": the glossary replaces \"" << match.str()
        << "\": " << text.substr(0, 300);
  };
  int count = 0;
  for (const fs::path& file : files_below({"app", "engine", "haptics", "tools/sulcus_lab"})) {
    const std::string extension = file.extension().string();
    if (extension == ".gp") {  // a chart's labels
      for (const std::string& line : lines_of(file)) {
        if (!line.starts_with('#')) check(file, line);
      }
    }
    if (extension != ".cpp" && extension != ".hpp" && extension != ".in") continue;
    for (const std::string& literal : literals_of(test::read_file(file.string()))) {
      check(file, literal);
      ++count;
    }
  }
  EXPECT_GT(count, 3000);
  for (const fs::path& readme : test::readmes(kRoot)) {
    for (const std::string& line : lines_of(readme)) {
      if (line == kGlossary) break;  // the last of its README
      check(readme, line);
    }
  }
}

// --- Links --------------------------------------------------------------------------------------

std::vector<fs::path> documents() {
  std::vector<fs::path> documents = test::readmes(kRoot);
  documents.push_back(kRoot / "scenes/from_a_scan_to_a_cut_tooth.md");
  return documents;
}

/// Every match of a pattern's first group outside of blocks of code.
template <class Visit>
void for_every_match(const fs::path& document, const std::regex& pattern, const Visit& visit) {
  bool fenced = false;
  for (const std::string& line : lines_of(document)) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced || line.starts_with("    ")) continue;
    for (std::sregex_iterator it(line.begin(), line.end(), pattern), end; it != end; ++it)
      visit(*it);
  }
}

/// Of a heading, as GitHub makes it: small letters, no punctuation, hyphens for spaces.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading.substr(std::min(heading.find_first_not_of("# "), heading.size()))) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || c == '-' || c == '_') anchor += static_cast<char>(std::tolower(u));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

// As one that a formatter of C++ went over does not.
TEST(House, DocumentsBeginWithATitleAndTheirTablesAreWhole) {
  int tables = 0;
  for (const fs::path& document : documents()) {
    const std::vector<std::string> lines = lines_of(document);
    ASSERT_FALSE(lines.empty()) << document;
    EXPECT_TRUE(lines.front().starts_with("# ")) << document;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto is_row = [](const std::string& line) {
        const std::size_t begin = line.find_first_not_of(' ');
        return begin < 4 && line[begin] == '|';  // further in are drawings
      };
      const std::string& line = lines[i];
      if (!is_row(line)) continue;
      EXPECT_TRUE(line.ends_with('|')) << name_of(document) << ": " << line;
      if (i > 0 && is_row(lines[i - 1])) continue;
      EXPECT_TRUE(i + 1 < lines.size() && lines[i + 1].find("|---") != std::string::npos)
          << name_of(document) << ": " << line;
      ++tables;
    }
  }
  EXPECT_GT(tables, 50);
}

TEST(House, LinksLeadSomewhere) {
  const std::regex link(R"(\]\(([^)#\s]*)#?([^)\s]*)\))");
  int count = 0;
  for (const fs::path& document : documents()) {
    for_every_match(document, link, [&](const std::smatch& match) {
      const std::string to = match[1], anchor = match[2];
      if (to.starts_with("http")) return;
      ++count;
      const fs::path target = to.empty() ? document : document.parent_path() / to;
      EXPECT_TRUE(fs::exists(target)) << name_of(document) << " links to " << to;
      if (anchor.empty() || !fs::exists(target)) return;
      const std::vector<std::string> lines = lines_of(target);
      EXPECT_TRUE(std::ranges::any_of(lines,
                                      [&](const std::string& line) {
                                        return line.starts_with("#") && anchor_of(line) == anchor;
                                      }))
          << name_of(document) << " links to " << to << "#" << anchor;
    });
  }
  EXPECT_GT(count, 50);
}

// `tools/lab`, `tick.hpp`: from the root or from the document's folder.
TEST(House, FilesThatReadmesNameAreThere) {
  const std::regex code("`([^`]+)`");
  const std::regex file(
      R"((app|engine|haptics|assets|scenes|tests|tools)/[\w./]*|[\w./]+\.(cpp|hpp|h|py))");
  int count = 0;
  for (const fs::path& document : documents()) {
    for_every_match(document, code, [&](const std::smatch& match) {
      std::istringstream words(match[1]);
      for (std::string word; words >> word;) {
        if (!std::regex_match(word, file) || word.find("NAME") != std::string::npos) continue;
        ++count;
        EXPECT_TRUE(fs::exists(kRoot / word) || fs::exists(document.parent_path() / word))
            << name_of(document) << " names " << word;
      }
    });
  }
  EXPECT_GT(count, 80);
}

}  // namespace
}  // namespace sulcus::house_test
