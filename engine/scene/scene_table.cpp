#include "engine/scene/scene_table.hpp"

#include <stdexcept>
#include <string>

namespace sulcus {

namespace {

/// What `read` finds in the table, else in the key's default: through the same checks as a file.
template <class Read>
auto read_or_default(TomlTable& table, const SceneKey& key, const Read& read) {
  if (const auto value = read(table)) return *value;
  if (!has_default(key)) throw std::logic_error("no default: " + std::string(key.key));
  const toml::table parsed =
      toml::parse(std::string(key.key).append(" = ").append(key.default_toml));
  TomlTable defaults(parsed, "scene_keys.cpp", "");
  return *read(defaults);
}

}  // namespace

const SceneKey& SceneTable::key_of(std::string_view key, KeyKind kind) const {
  const SceneKey* found = find_scene_key(name_, key);
  if (!found || found->kind != kind) {
    throw std::logic_error("not in scene_keys.cpp, or of another kind: " + name_ + "." +
                           std::string(key));
  }
  return *found;
}

std::optional<SceneTable> SceneTable::table(std::string_view key) {
  std::string name = name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  if (!find_scene_table(name)) throw std::logic_error("not in scene_keys.cpp: [" + name + "]");
  std::optional<TomlTable> inner = table_.table(key);
  if (!inner) return {};
  return SceneTable(std::move(*inner), std::move(name));
}

std::vector<SceneTable> SceneTable::tables(std::string_view key) {
  const SceneTableKeys* known = find_scene_table(key);
  if (!known || !known->repeated) {
    throw std::logic_error("not in scene_keys.cpp: [[" + std::string(key) + "]]");
  }
  std::vector<SceneTable> all;
  for (TomlTable& inner : table_.tables(key)) all.emplace_back(std::move(inner), std::string(key));
  return all;
}

std::optional<double> SceneTable::number_if(std::string_view key) {
  return table_.number(key, key_of(key, KeyKind::kNumber).range);
}

double SceneTable::number(std::string_view key, double otherwise) {
  return number_if(key).value_or(otherwise);
}

double SceneTable::number(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kNumber);
  return read_or_default(table_, row,
                         [&](TomlTable& table) { return table.number(key, row.range); });
}

std::optional<int> SceneTable::whole_if(std::string_view key) {
  return table_.integer(key, key_of(key, KeyKind::kWhole).range);
}

int SceneTable::whole(std::string_view key, int otherwise) {
  return whole_if(key).value_or(otherwise);
}

int SceneTable::whole(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kWhole);
  return read_or_default(table_, row,
                         [&](TomlTable& table) { return table.integer(key, row.range); });
}

std::vector<double> SceneTable::numbers_if(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kNumbers);
  return table_.numbers(key, row.count, row.range);
}

std::vector<double> SceneTable::numbers(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kNumbers);
  return read_or_default(table_, row, [&](TomlTable& table) {
    std::vector<double> values = table.numbers(key, row.count, row.range);
    return values.empty() ? std::nullopt : std::optional(std::move(values));
  });
}

Eigen::Vector3d SceneTable::vector3(std::string_view key) {
  const std::vector<double> v = numbers(key);
  return {v.at(0), v.at(1), v.at(2)};
}

bool SceneTable::boolean(std::string_view key) {
  return read_or_default(table_, key_of(key, KeyKind::kBoolean),
                         [&](TomlTable& table) { return table.boolean(key); });
}

std::optional<std::size_t> SceneTable::choice_if(std::string_view key) {
  return table_.choice(key, key_of(key, KeyKind::kChoice).words);
}

std::size_t SceneTable::choice(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kChoice);
  return read_or_default(table_, row,
                         [&](TomlTable& table) { return table.choice(key, row.words); });
}

std::string SceneTable::text(std::string_view key, std::string otherwise) {
  (void)key_of(key, KeyKind::kText);
  return table_.text(key).value_or(std::move(otherwise));
}

std::optional<Eigen::Vector3d> SceneTable::direction_if(std::string_view key) {
  (void)key_of(key, KeyKind::kDirection);
  return table_.direction(key);
}

Eigen::Vector3d SceneTable::direction(std::string_view key) {
  return read_or_default(table_, key_of(key, KeyKind::kDirection),
                         [&](TomlTable& table) { return table.direction(key); });
}

std::vector<double> SceneTable::limit(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kLimit);
  return table_.limit(key, row.range);
}

std::vector<std::vector<double>> SceneTable::rows(std::string_view key) {
  const SceneKey& row = key_of(key, KeyKind::kRows);
  return table_.rows(key, row.count, row.fields, row.range);
}

std::string SceneTable::path(std::string_view key) {
  (void)key_of(key, KeyKind::kPath);
  return table_.path(key);
}

void SceneTable::expect_word(std::string_view key, std::string_view word) {
  (void)table_.choice(key, std::span(&word, 1));
}

}  // namespace sulcus
