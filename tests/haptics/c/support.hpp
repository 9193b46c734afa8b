#pragma once

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "haptics/c/sulcus.h"

namespace sulcus::test {

inline std::string golden(const std::string& name) {
  return SULCUS_SOURCE_DIR "/tests/golden/" + name + ".toml";
}

/// What a golden scene was decided to come to.
inline nlohmann::json golden_results(const std::string& name) {
  return nlohmann::json::parse(std::ifstream(SULCUS_SOURCE_DIR "/tests/golden/" + name + ".json"));
}

inline std::string text_of(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// A handle that is freed with its test.
class Handle {
 public:
  Handle() = default;
  explicit Handle(const std::string& file) { open_file(file); }
  ~Handle() { sulcus_free(&simulation_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  void open_file(const std::string& file) {
    char error[512] = "";
    EXPECT_EQ(sulcus_open_file(file.c_str(), &simulation_, error, sizeof error), SULCUS_DONE)
        << error;
  }
  void step_scene(std::uint64_t ticks) {
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      ASSERT_EQ(sulcus_step_scene(simulation_, nullptr), SULCUS_DONE);
    }
  }
  std::string volume_hash() const { return hash_by(sulcus_volume_hash); }
  std::string force_hash() const { return hash_by(sulcus_force_hash); }
  std::string state_hash() const { return hash_by(sulcus_state_hash); }
  std::uint64_t ticks() const {
    std::uint64_t ticks = 0;
    EXPECT_EQ(sulcus_scene_ticks(simulation_, &ticks), SULCUS_DONE);
    return ticks;
  }
  operator SulcusSimulation*() const { return simulation_; }
  SulcusSimulation** address() { return &simulation_; }

 private:
  std::string hash_by(int (*read)(const SulcusSimulation*, std::uint64_t*)) const {
    std::uint64_t hash = 0;
    EXPECT_EQ(read(simulation_, &hash), SULCUS_DONE);
    return text_of(hash);
  }

  SulcusSimulation* simulation_ = nullptr;
};

}  // namespace sulcus::test
