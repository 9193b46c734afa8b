#include "engine/import/input_files.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/core/ascii.hpp"
#include "engine/import/volumes/volume_checks.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

/// Values of the fields of an NRRD or MetaImage header that name its data.
std::vector<std::string> data_names(const fs::path& header) {
  std::ifstream in(header, std::ios::binary);
  std::string text(kMaxHeaderBytes, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    const std::size_t colon = line.find_first_of(":=");
    if (colon == std::string_view::npos) continue;
    const std::string key = lower_case(trimmed(line.substr(0, colon)));
    if (key == "data file" || key == "datafile" || key == "elementdatafile") {
      names.push_back(trimmed(line.substr(colon + 1)));
    }
  }
  return names;
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// The files whose contents decide what a reader of `path` gets.
std::optional<std::vector<fs::path>> input_files(const fs::path& path) {
  std::error_code error;
  std::vector<fs::path> files;
  if (fs::is_directory(path, error)) {
    for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
      if (is_file(it->path())) files.push_back(it->path());
    }
    if (error) return std::nullopt;
    std::ranges::sort(files);  // a folder has no order of its own
    return files;
  }
  if (!is_file(path)) return std::nullopt;  // a pipe or a device, which may never end
  files.push_back(path);
  const std::string name = lower_case(path.filename().string());
  const auto ends = [&](std::string_view extension) { return name.ends_with(extension); };
  if (ends(".nrrd") || ends(".nhdr") || ends(".mha") || ends(".mhd")) {
    for (const std::string& data : data_names(path)) {
      if (lower_case(data) == "local") continue;
      if (!is_file(path.parent_path() / data)) return std::nullopt;
      files.push_back(path.parent_path() / data);
    }
  } else if (ends(".hdr") || ends(".img") || ends(".img.gz")) {
    fs::path stem = path;
    if (ends(".gz")) stem.replace_extension();
    for (const char* extension : {".hdr", ".hdr.gz", ".img", ".img.gz"}) {
      const fs::path beside = stem.replace_extension().string() + extension;
      if (beside != path && is_file(beside)) files.push_back(beside);
    }
  }
  return files;
}

}  // namespace

std::optional<Hash128> hash_input(const std::string& path) {
  const std::optional<std::vector<fs::path>> files = input_files(path);
  if (!files) return std::nullopt;
  std::vector<std::optional<Hash128>> hashes(files->size());
  tbb::parallel_for(std::size_t{0}, files->size(),
                    [&](std::size_t f) { hashes[f] = hash_file((*files)[f].string()); });
  Hash128Stream stream;
  std::error_code ignored;
  const bool folder = fs::is_directory(path, ignored);
  stream.add(folder);
  for (std::size_t f = 0; f < files->size(); ++f) {
    if (!hashes[f]) return std::nullopt;
    const fs::path& file = (*files)[f];
    // The name of a single file says no more than its format; slices are put in order by theirs.
    const std::string name = file.filename().string();
    stream.add(folder ? name : lower_case(name.substr(std::min(name.find('.'), name.size()))));
    stream.add(*hashes[f]);
  }
  return stream.result();
}

}  // namespace sulcus
