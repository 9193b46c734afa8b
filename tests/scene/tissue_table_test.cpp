#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "engine/scene/table_readers.hpp"

namespace sulcus {
namespace {

TEST(TissueTable, IsTheFileOfTheAssets) {
  std::ifstream in(SULCUS_SOURCE_DIR "/assets/tissues.toml", std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  ASSERT_FALSE(text.str().empty());
  EXPECT_EQ(tissue_table_toml(), text.str());
}

}  // namespace
}  // namespace sulcus
