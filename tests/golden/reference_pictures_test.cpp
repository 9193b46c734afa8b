// Pictures of whole runs, drawn at full size through EGL, against reference pictures that were
// looked at. `SULCUS_REFERENCE=write build/release/tests/sulcus_golden_tests
// --gtest_filter='ReferencePictures.*'` makes those anew: look at each before it is kept, also at
// full size (SULCUS_REFERENCE_FULL=FOLDER writes that).
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/playback/recorded_film.hpp"
#include "engine/graphics/renderer.hpp"
#include "tests/support/command.hpp"
#include "tests/support/looks_like.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/specks.hpp"

namespace sulcus::reference_pictures_test {
namespace {

constexpr int kWidth = 1920, kHeight = 1080;
/// A quarter of it: what is kept, once all of the picture from further away, once a part of it.
constexpr int kFactor = 4, kKeptWidth = kWidth / kFactor, kKeptHeight = kHeight / kFactor;

/// A picture to be drawn, and what of it is kept at full size.
struct Shot {
  std::string name;
  double at_s;
  Viewpoint from;
  bool burr_shown = false;
  std::optional<Section> section = {};
  int detail_left = (kWidth - kKeptWidth) / 2, detail_top = (kHeight - kKeptHeight) / 2;
  std::size_t most_speck_pixels = 120;
  test::LooksLikeLimits limits = {};
};

/// A recorded run as it is drawn. Throws without OpenGL, as make_renderer below tests/graphics.
struct Film {
  explicit Film(const std::string& recording) : reader(recording), film(reader, recording) {
    RenderSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.hud = false;
    renderer = std::make_unique<Renderer>(settings, film.bodies(), film.burr().mesh_tool,
                                          film.burr().head_length_m);
  }
  Image draw(const Shot& shot) {
    FrameState state = film.seek_row(film.row_at(shot.at_s), *renderer);
    state.burr_shown = shot.burr_shown;
    renderer->set_viewpoint(shot.from);
    renderer->set_section(shot.section);
    return renderer->draw(state);
  }

  RecordingReader reader;
  RecordedFilm film;
  std::unique_ptr<Renderer> renderer;
};

std::string record(const ScratchFolder& scratch, const std::string& scene_and_options) {
  const auto result = test::sulcus_command("run " SULCUS_SOURCE_DIR "/scenes/" + scene_and_options +
                                               " --pace fast --no-render -o " + scratch.path("out"),
                                           scratch.path("err"));
  EXPECT_EQ(result.status, 0) << result.err;
  return scratch.path("out/recording.h5");
}

/// Against the reference of that name; one that does not look like it stays, to be looked at.
void compare(const Image& image, const std::string& name, const test::LooksLikeLimits& limits) {
  const std::string file = SULCUS_SOURCE_DIR "/tests/golden/pictures/" + name + ".png";
  const char* wish = std::getenv("SULCUS_REFERENCE");
  if (wish && std::string(wish) == "write") {
    test::write_small_png(image, file);
    return;
  }
  const auto alike = test::looks_like(image, test::read_png(file), limits);
  if (alike) return;
  const std::string drawn = testing::TempDir() + "sulcus_" + name + ".png";
  write_png(image, drawn);
  ADD_FAILURE() << drawn << " does not look like " << file << ": " << alike.message();
}

/// At full size, where SULCUS_REFERENCE_FULL names a folder.
void keep_to_look_at(const Image& image, const std::string& name) {
  if (const char* folder = std::getenv("SULCUS_REFERENCE_FULL")) {
    write_png(image, std::string(folder) + "/" + name + ".png");
  }
}

/// At full size, and the larger ones from further away. A burr's edges and fissures have a few.
void expect_few_specks(const Image& image, const Shot& shot) {
  EXPECT_LE(test::speck_pixels(image), shot.most_speck_pixels) << shot.name;
  EXPECT_LE(test::speck_pixels(test::reduced(image, kFactor)), 40u) << shot.name;
}

TEST(ReferencePictures, TheMolarAndTheCavityInIt) {
  const ScratchFolder scratch;
  Film film(record(scratch, "class_one_cavity.toml"));
  constexpr double kDone_s = 18.4;  // the burr is off the tooth
  const std::vector<Shot> shots{
      {.name = "molar", .at_s = 0.0, .from = Camera::kReview},
      {.name = "fissures", .at_s = 0.0, .from = Camera::kOcclusal},
      {.name = "crown_close", .at_s = 1.2, .from = Camera::kBurr, .burr_shown = true},
      {.name = "cavity", .at_s = kDone_s, .from = Camera::kOcclusal},
      {.name = "cavity_open",
       .at_s = kDone_s,
       .from = Viewpoint(-80.0, 20.0),
       .section = Section{1, 0.0},
       .detail_top = 160},
  };
  for (const Shot& shot : shots) {
    const Image image = film.draw(shot);
    keep_to_look_at(image, shot.name);
    expect_few_specks(image, shot);
    compare(test::reduced(image, kFactor), shot.name, shot.limits);
    compare(test::cropped(image, shot.detail_left, shot.detail_top, kKeptWidth, kKeptHeight),
            shot.name + "_detail", shot.limits);
  }
}

/// Of the tooth's pixels in some rows, the share that has the yellow of dentine. The background is
/// bluish, and b* of enamel is below 10.
double dentine_share(const Image& image, int top, int bottom) {
  std::size_t tooth = 0, dentine = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = test::pixel(image, x, y);
      const double b =
          test::cielab_of(test::light_of(p[0]), test::light_of(p[1]), test::light_of(p[2]))[2];
      tooth += b > 0.0;
      dentine += b > 14.0;
    }
  }
  return static_cast<double>(dentine) / static_cast<double>(std::max<std::size_t>(tooth, 1));
}

// Its licence is not ours to pass on, nor are pictures of it: none is kept.
TEST(ReferencePictures, ACutCtToothHasItsTissuesAndNoSpecks) {
  const std::string tooth = SULCUS_SOURCE_DIR "/../shared/data/ge_tooth/tooth_103x94x161_u16.nrrd";
  if (!std::filesystem::exists(tooth)) GTEST_SKIP() << "no " << tooth;
  const ScratchFolder scratch;
  Film film(record(scratch, "cut_ct_tooth.toml --set workpiece.file=" + tooth));
  const double end_s = film.film.rows().back().time_s;
  const std::vector<Shot> shots{
      {.name = "ct_tooth", .at_s = end_s, .from = Camera::kReview},
      {.name = "ct_side", .at_s = end_s, .from = Camera::kBuccal},
      {.name = "ct_crown", .at_s = end_s, .from = Camera::kOcclusal},
      {.name = "ct_close", .at_s = 0.5 * end_s, .from = Camera::kBurr, .burr_shown = true},
      {.name = "ct_open",
       .at_s = end_s,
       .from = Viewpoint(-80.0, 20.0),
       .section = Section{1, 0.0}},
  };
  for (const Shot& shot : shots) {
    const Image image = film.draw(shot);
    keep_to_look_at(image, shot.name);
    expect_few_specks(image, shot);
    if (shot.name == "ct_side") {
      EXPECT_LT(dentine_share(image, 0, kHeight / 4), 0.05) << "enamel above";
      EXPECT_GT(dentine_share(image, kHeight * 2 / 3, kHeight), 0.9) << "dentine below";
    }
  }
}

}  // namespace
}  // namespace sulcus::reference_pictures_test
