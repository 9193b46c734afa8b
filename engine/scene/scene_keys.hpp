#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace sulcus {

// Every key that a scene may have, once: the reader (scene_table.hpp) takes kinds, ranges and
// defaults from here and can read no key that is not here; `sulcus help scene` prints it.

/// A range that a number must lie in, ends included.
struct Range {
  double least, most;
};

enum class KeyKind : std::uint8_t {
  kNumber,
  kWhole,      // a whole number
  kNumbers,    // an array of `count` numbers
  kLimit,      // a number or an array of two, the least and the most
  kRows,       // an array of at least one such array
  kDirection,  // three numbers, of any length but none
  kBoolean,
  kText,
  kChoice,  // one of `words`
  kPath,
};

struct SceneKey {
  std::string_view key;
  KeyKind kind;
  Range range;                              // of each number; of other kinds: not used
  std::size_t count;                        // of numbers in an array
  std::span<const std::string_view> words;  // of a choice
  /// As TOML: what the reader takes where the key is not there. In brackets "(...)": where that
  /// comes from. Empty: it must be there, or nothing follows from its absence.
  std::string_view default_toml;
  std::string_view what;    // with the source of a value in [], where it is not ours
  std::string_view fields;  // of a row, "x, y, z"
};

struct SceneTableKeys {
  std::string_view name;  // "workpiece.sphere"; empty: the top of the file
  bool repeated;          // [[name]]
  std::string_view what;
  std::span<const SceneKey> keys;
  std::string_view inherits_from;  // a table whose keys, and tables, it may have as well
};

/// All tables, in the order of the reader.
std::span<const SceneTableKeys> scene_tables() noexcept;

/// The table of a name, by its own keys or by those that it has from another ("body.sphere" is
/// "workpiece.sphere"). Null: there is none.
const SceneTableKeys* find_scene_table(std::string_view name) noexcept;
/// A key of a table, its own or one that it has from another. Null: there is none.
const SceneKey* find_scene_key(std::string_view table, std::string_view key) noexcept;

/// Whether `default_toml` is what the reader takes, not words about it.
constexpr bool has_default(const SceneKey& key) {
  return !key.default_toml.empty() && key.default_toml.front() != '(';
}

/// The unit that a key's name ends in, as it is printed ("N/mm" for stiffness_N_per_mm); empty: it
/// has none.
std::string_view unit_of_key(std::string_view key) noexcept;

}  // namespace sulcus
