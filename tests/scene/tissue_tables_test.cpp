#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/table_readers.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::tissue_tables_test {
namespace {

using test::error_of, test::least_scene, test::parse;

TEST(TissueTables, IsTheFileOfTheAssets) {
  std::ifstream in(SULCUS_SOURCE_DIR "/assets/tissues.toml", std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  ASSERT_FALSE(text.str().empty());
  EXPECT_EQ(tissue_table_toml(), text.str());
}

TEST(TissueTables, KnownTissuesBringTheirConstants) {
  const Scene s = parse("tissue = ['enamel', 'dentine', 'pulp', 'caries']\n" + least_scene());
  ASSERT_EQ(s.tissues.size(), 4u);
  EXPECT_EQ(s.tissues[1].name, "dentine");
  EXPECT_DOUBLE_EQ(s.tissues[0].specific_energy_J_per_m3, 3.5e9);
  EXPECT_DOUBLE_EQ(s.tissues[1].specific_energy_J_per_m3, 0.65e9);
  EXPECT_DOUBLE_EQ(s.tissues[1].stiffness_N_per_m, 25e3);
  EXPECT_DOUBLE_EQ(s.tissues[3].stiffness_N_per_m, 8e3);
  EXPECT_GT(s.tissues[3].specific_energy_J_per_m3, s.tissues[2].specific_energy_J_per_m3);
}

TEST(TissueTables, ATissueTableKeepsTheConstantsItDoesNotName) {
  const Scene s = parse(least_scene() + "[[tissue]]\nname = 'dentine'\nstiffness_N_per_mm = 3\n");
  ASSERT_EQ(s.tissues.size(), 1u);
  EXPECT_DOUBLE_EQ(s.tissues[0].stiffness_N_per_m, 3e3);
  EXPECT_DOUBLE_EQ(s.tissues[0].specific_energy_J_per_m3, 0.65e9);
}

TEST(TissueTables, TissueErrorsNameTheTissue) {
  EXPECT_EQ(error_of("tissue = ['enamel', 'bone']\n" + least_scene()),
            "/scenes/s.toml: line 1, column 10, tissue: found 'bone', expected enamel, dentine, "
            "pulp or caries, or a [[tissue]]");
  EXPECT_EQ(error_of(least_scene() + "[[tissue]]\nname = 'a'\n[[tissue]]\nname = 'a'\n"),
            "/scenes/s.toml: line 5, column 1, tissue: found 'a' twice, expected names that "
            "differ");
  EXPECT_NE(error_of(least_scene() + "[[tissue]]\nabove = 3\n").find("expected a name"),
            std::string::npos);
}

// --- [[body]] -----------------------------------------------------------------------------------

}  // namespace
}  // namespace sulcus::tissue_tables_test
