#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "engine/scene/table_readers.hpp"

namespace sulcus {

namespace {

/// What a message's header has room for.
constexpr std::size_t kLongestName = 20;

bool is_device_name(std::string_view name) {
  return name.size() <= kLongestName &&
         std::ranges::all_of(name, [](char c) { return c > ' ' && c <= '~'; });
}

}  // namespace

StreamSettings read_stream(SceneTable& table) {
  StreamSettings s;
  s.address = table.text("address", s.address);
  s.port = table.whole("port");
  s.rate_hz = table.number("rate_hz");
  const std::array<std::pair<std::string_view, std::string*>, 9> names{{{"tick", &s.tick},
                                                                        {"tool", &s.tool},
                                                                        {"hand", &s.hand},
                                                                        {"force", &s.force},
                                                                        {"torque", &s.torque},
                                                                        {"speed", &s.speed},
                                                                        {"removed", &s.removed},
                                                                        {"state", &s.state},
                                                                        {"tooth", &s.tooth}}};
  for (const auto& [key, name] : names) {
    *name = table.text(key, *name);
    if (!is_device_name(*name)) {
      table.fail(key, "'" + *name + "'", "at most 20 characters of ASCII, without spaces");
    }
    for (const auto& [earlier_key, earlier] : names) {
      if (earlier_key == key) break;
      if (!name->empty() && *earlier == *name) {
        table.fail(key, "'" + *name + "', the name of " + std::string(earlier_key),
                   "a name of its own");
      }
    }
  }
  table.finish();
  return s;
}

}  // namespace sulcus
