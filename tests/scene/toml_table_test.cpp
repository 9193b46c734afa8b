#include "engine/scene/toml_table.hpp"

#include <array>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"

namespace sulcus::toml_table_test {
namespace {

/// The message of the InputError that reading `text` with `read` gives; empty: none.
std::string error_of(const std::string& text, const std::function<void(TomlTable&)>& read) {
  const toml::table parsed = toml::parse(text, std::string_view("f.toml"));
  TomlTable table(parsed, "f.toml", "");
  try {
    read(table);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// What `read` makes of `text`.
template <class Read>
auto read_from(const std::string& text, const Read& read) {
  const toml::table parsed = toml::parse(text, std::string_view("f.toml"));
  TomlTable table(parsed, "f.toml", "");
  return read(table);
}

TEST(TomlTable, ANumberMayBeWholeOrNot) {
  const auto read = [](TomlTable& t) { return t.number("a", {0, 10}).value_or(7.0); };
  EXPECT_EQ(read_from("a = 3", read), 3.0);
  EXPECT_EQ(read_from("a = 2.5", read), 2.5);
  EXPECT_EQ(read_from("b = 2.5", read), 7.0);
}

TEST(TomlTable, RangesHoldTheirEnds) {
  const auto read = [](TomlTable& t) { (void)t.number("a", {1, 2}); };
  EXPECT_EQ(error_of("a = 1", read), "");
  EXPECT_EQ(error_of("a = 2.0", read), "");
  EXPECT_EQ(error_of("a = 2.1", read), "f.toml: line 1, column 5, a: found 2.1, expected 1 to 2");
  EXPECT_EQ(error_of("\n\n  a = 0", read), "f.toml: line 3, column 7, a: found 0, expected 1 to 2");
  EXPECT_EQ(error_of("a = nan", read), "f.toml: line 1, column 5, a: found nan, expected 1 to 2");
  EXPECT_EQ(error_of("a = inf", read), "f.toml: line 1, column 5, a: found inf, expected 1 to 2");
}

TEST(TomlTable, AWrongTypeIsNamed) {
  EXPECT_EQ(error_of("a = 'x'",
                     [](TomlTable& t) {
                       (void)t.number("a", {1, 2});
                     }),
            "f.toml: line 1, column 5, a: found 'x', expected a number, 1 to 2");
  EXPECT_EQ(error_of("a = 1.5",
                     [](TomlTable& t) {
                       (void)t.integer("a", {1, 2});
                     }),
            "f.toml: line 1, column 5, a: found 1.5, expected a whole number, 1 to 2");
  EXPECT_EQ(error_of("a = 1", [](TomlTable& t) { (void)t.boolean("a"); }),
            "f.toml: line 1, column 5, a: found 1, expected true or false");
  EXPECT_EQ(error_of("a = 1", [](TomlTable& t) { (void)t.text("a"); }),
            "f.toml: line 1, column 5, a: found 1, expected a text in quotes");
  EXPECT_EQ(error_of("a = 1", [](TomlTable& t) { (void)t.table("a"); }),
            "f.toml: line 1, column 5, a: found 1, expected a table, [a]");
  EXPECT_EQ(error_of("a = 1", [](TomlTable& t) { (void)t.tables("a"); }),
            "f.toml: line 1, column 5, a: found 1, expected tables, [[a]]");
  EXPECT_EQ(error_of("a = [1, 2]",
                     [](TomlTable& t) {
                       (void)t.numbers("a", 3, {0, 9});
                     }),
            "f.toml: line 1, column 5, a: found [ 1, 2 ], expected 3 numbers, 0 to 9");
  EXPECT_EQ(error_of("a = [1, 2]",
                     [](TomlTable& t) {
                       (void)t.rows("a", 3, "x, y, z", {0, 9});
                     }),
            "f.toml: line 1, column 5, a: found 1, expected [[x, y, z], ...]");
}

TEST(TomlTable, EveryElementIsChecked) {
  EXPECT_EQ(error_of("a = [1, 2, 30]",
                     [](TomlTable& t) {
                       (void)t.numbers("a", 3, {0, 9});
                     }),
            "f.toml: line 1, column 5, a: found 30, expected 0 to 9");
  EXPECT_EQ(error_of("a = [1, 2, 'x']",
                     [](TomlTable& t) {
                       (void)t.numbers("a", 3, {0, 9});
                     }),
            "f.toml: line 1, column 5, a: found 'x', expected a number, 0 to 9");
  const auto points = [](TomlTable& t) { (void)t.rows("a", 3, "x, y, z", {0, 9}); };
  EXPECT_NE(error_of("a = []", points), "");
  EXPECT_NE(error_of("a = [[1, 2]]", points), "");
  EXPECT_NE(error_of("a = [[1, 2, 3], [1, 2, 3, 4]]", points), "");
  EXPECT_NE(error_of("a = [[1, 2, -3]]", points), "");
  EXPECT_EQ(error_of("a = [[1, 2, 3], [4, 5, 6]]", points), "");
}

TEST(TomlTable, AChoiceListsItsWords) {
  constexpr std::array<std::string_view, 3> kWords{"red", "green", "blue"};
  const auto read = [&](TomlTable& t) { return t.choice("a", kWords); };
  EXPECT_EQ(read_from("a = 'green'", read), 1u);
  EXPECT_EQ(read_from("b = 'green'", read), std::nullopt);
  EXPECT_EQ(error_of("a = 'grey'", read),
            "f.toml: line 1, column 5, a: found 'grey', expected one of red, green, blue");
  EXPECT_EQ(error_of("a = 1", read),
            "f.toml: line 1, column 5, a: found 1, expected one of red, green, blue");
}

TEST(TomlTable, StringsAreThoseOfAnArrayOfNothingElse) {
  const auto read = [](TomlTable& t) { return t.strings("a"); };
  EXPECT_EQ(read_from("a = ['x', 'y']", read), (std::vector<std::string>{"x", "y"}));
  EXPECT_TRUE(read_from("a = ['x', 1]", read).empty());
  EXPECT_TRUE(read_from("a = 'x'", read).empty());
  EXPECT_TRUE(read_from("b = 1", read).empty());
}

TEST(TomlTable, KeysNobodyAskedForAreRefusedWithTheNearest) {
  const auto read = [](TomlTable& t) {
    (void)t.number("voxel_mm", {0, 1});
    (void)t.number("cells", {0, 1});
    t.finish();
  };
  EXPECT_EQ(error_of("voxel_mm = 1\ncells = 1", read), "");
  EXPECT_EQ(error_of("voxels_mm = 1", read),
            "f.toml: line 1, column 13, voxels_mm: found the unknown key 'voxels_mm', expected "
            "'voxel_mm'");
  EXPECT_EQ(error_of("speed = 1", read),
            "f.toml: line 1, column 9, speed: found the unknown key 'speed', expected one of "
            "voxel_mm, cells");
}

TEST(TomlTable, InnerTablesNameTheirPath) {
  const auto read = [](TomlTable& t) {
    auto outer = t.table("outer");
    auto inner = outer->table("inner");
    (void)inner->number("a", {0, 1});
  };
  EXPECT_EQ(error_of("[outer]\n[outer.inner]\na = 2", read),
            "f.toml: line 3, column 5, outer.inner.a: found 2, expected 0 to 1");
}

TEST(TomlTable, LongValuesAreShortened) {
  const std::string message = error_of("a = '" + std::string(500, 'x') + "'", [](TomlTable& t) {
    (void)t.number("a", {0, 1});
  });
  EXPECT_LT(message.size(), 150u);
  EXPECT_NE(message.find("xxx..., expected a number"), std::string::npos) << message;
}

TEST(TomlTable, AnEmptyPathIsRefused) {
  const auto read = [](TomlTable& t) { return t.path("a"); };
  EXPECT_EQ(read_from("", read), "");
  EXPECT_EQ(error_of("a = ''", read),
            "f.toml: line 1, column 5, a: found an empty text, expected a path");
}

TEST(NearestWord, IsTheOneOfTheSmallestEditDistance) {
  const std::vector<std::string> words{"neighbourhood", "normals", "trace", "rate_hz"};
  EXPECT_EQ(nearest_word("neighborhood", words), "neighbourhood");
  EXPECT_EQ(nearest_word("normal", words), "normals");
  EXPECT_EQ(nearest_word("tarce", words), "trace");
  EXPECT_EQ(nearest_word("zzzzzzzzzz", words), "");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace sulcus::toml_table_test
