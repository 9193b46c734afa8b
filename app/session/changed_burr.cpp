#include "app/session/changed_burr.hpp"

#include <algorithm>

#include "app/playback/continued_run.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

std::optional<Burr> changed_burr(const RecordedRun& run,
                                 const std::vector<std::string>& overrides) {
  if (std::ranges::none_of(overrides, asks_for_a_burr)) return {};
  LoadCache cache = LoadCache::of_user();
  return load_burr(parse_scene(run.reader.header().scene_toml, run.path, overrides), &cache);
}

}  // namespace sulcus
