#pragma once

#include "engine/scene/scene_keys.hpp"
#include "engine/scene/toml_table.hpp"

namespace sulcus {

/// A table of a scene being read: kinds, ranges and defaults of its keys are those of
/// scene_keys.cpp. std::logic_error on a key that is not there, or is there as another kind.
class SceneTable {
 public:
  /// `name`: as find_scene_table knows it.
  SceneTable(TomlTable table, std::string name)
      : table_(std::move(table)), name_(std::move(name)) {}

  bool has(std::string_view key) const { return table_.has(key); }
  bool is_text(std::string_view key) const { return table_.is_text(key); }
  std::optional<SceneTable> table(std::string_view key);
  std::vector<SceneTable> tables(std::string_view key);

  /// Those that have a default give it where they are absent.
  double number(std::string_view key);
  int whole(std::string_view key);
  std::vector<double> numbers(std::string_view key);
  Eigen::Vector3d vector3(std::string_view key);
  bool boolean(std::string_view key);
  std::size_t choice(std::string_view key);
  Eigen::Vector3d direction(std::string_view key);
  /// Those that have none: `otherwise`, or none.
  double number(std::string_view key, double otherwise);
  int whole(std::string_view key, int otherwise);
  std::string text(std::string_view key, std::string otherwise);
  std::optional<double> number_if(std::string_view key);
  std::optional<int> whole_if(std::string_view key);
  std::optional<std::size_t> choice_if(std::string_view key);
  std::optional<Eigen::Vector3d> direction_if(std::string_view key);
  std::vector<double> numbers_if(std::string_view key);
  /// One number, or the least and the most; empty where it is absent.
  std::vector<double> limit(std::string_view key);
  std::vector<std::vector<double>> rows(std::string_view key);
  std::string path(std::string_view key);
  /// Refuses any text but `word` for a key that is a text instead of what else it may be.
  void expect_word(std::string_view key, std::string_view word);
  /// See TomlTable.
  std::vector<std::string> strings(std::string_view key) { return table_.strings(key); }
  void finish() const { table_.finish(); }
  [[noreturn]] void fail(std::string_view key, std::string_view found,
                         std::string_view expected) const {
    table_.fail(key, found, expected);
  }

 private:
  const SceneKey& key_of(std::string_view key, KeyKind kind) const;

  TomlTable table_;
  std::string name_;
};

}  // namespace sulcus
