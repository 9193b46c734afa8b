#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <toml++/toml.h>

#include "engine/scene/scene_keys.hpp"

namespace sulcus {

/// One table of a TOML file being read: every key asked for is remembered, and `finish` refuses the
/// others. All errors are InputError with file, line and column, key, found and expected.
class TomlTable {
 public:
  /// `path` is the table's name for messages, empty for the whole file.
  TomlTable(const toml::table& table, std::string file, std::string path)
      : table_(table), file_(std::move(file)), path_(std::move(path)) {}

  bool has(std::string_view key) const { return table_.contains(key); }
  bool is_text(std::string_view key) const { return table_[key].is_string(); }
  /// A table inside; none when absent.
  std::optional<TomlTable> table(std::string_view key);
  /// The tables of an array of tables; none when absent.
  std::vector<TomlTable> tables(std::string_view key);

  // None when absent.
  std::optional<double> number(std::string_view key, Range range);
  std::optional<int> integer(std::string_view key, Range range);
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::string> text(std::string_view key);
  /// Exactly `count` numbers; empty when absent.
  std::vector<double> numbers(std::string_view key, std::size_t count, Range range);
  /// One number, or the least and the most of a range; empty when absent.
  std::vector<double> limit(std::string_view key, Range range);
  /// Rows of as many numbers as `names` ("x, y, z") says, at least one row; empty when absent.
  std::vector<std::vector<double>> rows(std::string_view key, std::size_t count,
                                        std::string_view names, Range range);
  /// A direction of any length, as a unit vector; none when absent.
  std::optional<Eigen::Vector3d> direction(std::string_view key);
  /// One of `words`, as its place among them.
  std::optional<std::size_t> choice(std::string_view key, std::span<const std::string_view> words);
  /// The strings of an array that holds nothing else; empty when it is anything else or absent.
  std::vector<std::string> strings(std::string_view key);
  /// A path made absolute: against the current folder when it came from --set, else against the
  /// file's. Empty when absent.
  std::string path(std::string_view key);

  /// Refuses every key that nobody asked for, with the nearest one that somebody did.
  void finish() const;

  [[noreturn]] void fail(std::string_view key, std::string_view found,
                         std::string_view expected) const;

 private:
  const toml::node* find(std::string_view key);
  std::string place(std::string_view key) const;
  double checked(std::string_view key, const toml::node& node, Range range) const;

  const toml::table& table_;
  std::string file_, path_;
  std::vector<std::string> known_;
};

/// Source path that marks nodes which came from --set.
inline constexpr std::string_view kFromOverride = "--set";

/// The word of `words` with the smallest edit distance to `word`; empty when none is at all near.
std::string nearest_word(std::string_view word, std::span<const std::string> words);

/// A TOML value as it would be written, shortened for a message.
std::string describe(const toml::node& node);

/// Refuses a text in which arrays and inline tables lie deeper than InputLimits::kSceneDepth or
/// whose keys have more parts, before toml++ reads it: it removes a table of tables by recursion,
/// and a key of 10^5 parts makes as many tables. Anything else that is no TOML passes.
/// @throws InputError with line and column.
void check_toml_depth(std::string_view text, const std::string& file);

/// The tables of a text. InputError with line and column where it is no TOML, or as
/// check_toml_depth; `expected` says what it was to be.
toml::table parse_toml(const std::string& text, const std::string& file, std::string_view expected);

/// Applies one `--set TABLE.KEY=VALUE` to a scene: the value is read as TOML, else taken as a
/// string; tables that are not there are made; `tissue.NAME.KEY` addresses a [[tissue]] by its
/// name, and a workpiece's file takes the place of its shape. The nodes carry that they came from
/// --set (kFromOverride). InputError for what is none; whether a key is known is found when the
/// scene is read.
void apply_override(toml::table& root, const std::string& text);

}  // namespace sulcus
