#include <string>

#include <gtest/gtest.h>

#include "engine/scene/scene_keys.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::stream_table_test {
namespace {

using test::error_of, test::least_scene, test::parse;

TEST(StreamOfAScene, WithoutItThereIsNone) { EXPECT_FALSE(parse(least_scene()).stream); }

TEST(StreamOfAScene, ItIsReadAsItIs) {
  const StreamSettings stream =
      *parse(least_scene() +
             "[stream]\naddress = '0.0.0.0'\nport = 20000\nrate_hz = 12.5\ntool = 'Burr'\n"
             "force = ''\n")
           .stream;
  EXPECT_EQ(stream.address, "0.0.0.0");
  EXPECT_EQ(stream.port, 20000);
  EXPECT_EQ(stream.rate_hz, 12.5);
  EXPECT_EQ(stream.tool, "Burr");
  EXPECT_EQ(stream.force, "");
}

// What `sulcus help scene` prints is what is taken.
TEST(StreamOfAScene, DefaultsAreThoseOfTheHelp) {
  const StreamSettings stream = *parse(least_scene() + "[stream]\n").stream;
  const auto expect_text = [](std::string_view key, const std::string& taken) {
    EXPECT_EQ(find_scene_key("stream", key)->default_toml, '"' + taken + '"') << key;
  };
  expect_text("address", stream.address);
  expect_text("tick", stream.tick);
  expect_text("tool", stream.tool);
  expect_text("hand", stream.hand);
  expect_text("force", stream.force);
  expect_text("torque", stream.torque);
  expect_text("speed", stream.speed);
  expect_text("removed", stream.removed);
  expect_text("state", stream.state);
  expect_text("tooth", stream.tooth);
  EXPECT_EQ(stream.port, 18944);
  EXPECT_EQ(stream.rate_hz, 50.0);
}

TEST(StreamOfAScene, NamesHaveToFitAHeader) {
  const std::string stream = least_scene() + "[stream]\n";
  EXPECT_EQ(error_of(stream + "tool = 'abcdefghijklmnopqrst'\n"), "no error");
  for (const char* name : {"abcdefghijklmnopqrstu", "the burr", "Fr\xc3\xa4ser"}) {
    EXPECT_NE(error_of(stream + "tool = '" + name + "'\n")
                  .find("expected at most 20 characters of ASCII, without spaces"),
              std::string::npos)
        << name;
  }
}

TEST(StreamOfAScene, NoTwoHaveOneName) {
  const std::string stream = least_scene() + "[stream]\n";
  EXPECT_NE(
      error_of(stream + "torque = 'Force'\n")
          .find("stream.torque: found 'Force', the name of force, expected a name of its own"),
      std::string::npos);
  EXPECT_EQ(error_of(stream + "torque = ''\nforce = ''\n"), "no error");
}

}  // namespace
}  // namespace sulcus::stream_table_test
