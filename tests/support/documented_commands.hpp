#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace sulcus::test {

/// The README of every folder of a checkout, the first one first, the others by their names.
inline std::vector<std::filesystem::path> readmes(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  std::vector<fs::path> found;
  for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator();
       ++it) {
    const std::string name = it->path().filename().string();
    const bool made = it.depth() == 0 && (name == "build" || name == "out");
    if (it->is_directory() && (made || name.starts_with('.'))) it.disable_recursion_pending();
    if (it.depth() > 0 && name == "README.md") found.push_back(it->path());
  }
  std::ranges::sort(found);
  found.insert(found.begin(), root / "README.md");
  return found;
}

/// What a document tells its reader to do, in its order: a command for a shell, or a file to write.
struct DocumentedStep {
  int line = 0;      // in the document, from 1
  std::string file;  // empty: `text` is a command
  std::string text;
};

/// Commands are the lines of indented or fenced (```sh) blocks that begin with one of `programs`,
/// joined where they end in a backslash, without the remark after " # ". A file is a ```toml block
/// that follows a line which ends in its name: `name.toml`:
inline std::vector<DocumentedStep> documented_steps(const std::filesystem::path& document,
                                                    const std::vector<std::string>& programs) {
  std::vector<DocumentedStep> steps;
  std::ifstream in(document);
  std::string before, fence;
  bool goes_on = false;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with("```")) {
      const bool opens = fence.empty();
      fence = opens ? line + " " : "";
      const std::size_t last = before.rfind("`:");
      const std::size_t first =
          last == std::string::npos || last == 0 ? std::string::npos : before.rfind('`', last - 1);
      if (opens && line == "```toml" && first != std::string::npos) {
        steps.push_back({number, before.substr(first + 1, last - first - 1), ""});
      }
      continue;
    }
    if (fence == "```toml ") {
      if (!steps.empty() && !steps.back().file.empty()) steps.back().text += line + "\n";
      continue;
    }
    if (!line.empty()) before = line;
    const bool block = fence == "```sh " || (fence.empty() && line.starts_with("    "));
    if (!block) {
      goes_on = false;
      continue;
    }
    std::string text = line.substr(std::min(line.size(), line.find_first_not_of(' ')));
    if (const std::size_t remark = text.find(" # "); remark != std::string::npos) {
      text.resize(remark);
    }
    while (text.ends_with(' ')) text.pop_back();
    bool command = goes_on;
    for (const std::string& program : programs) command = command || text.starts_with(program);
    if (!command) continue;
    const bool more = text.ends_with('\\');
    if (more) text.pop_back();
    if (goes_on) {
      steps.back().text += " " + text;
    } else {
      steps.push_back({number, "", text});
    }
    goes_on = more;
  }
  return steps;
}

}  // namespace sulcus::test
