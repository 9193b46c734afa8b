// The pages of `render --review` and `assess`, opened in a browser and driven by a script.
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::page_test {
namespace {

using nlohmann::json;

/// A block with a goal, into which a burr is sunk, not as deep as it should. The title is made to
/// break out of HTML and of the page's data.
const std::string kSunkBurr = R"(
title = "</script><b>\"a\" & b</b><!--"
tissue = ["enamel"]
)" + test::block_and_fissure_burr("[4, 4, 2]", "0.1", "[48, 48, 32]") +
                              R"([trajectory]
axis = [0, 0, 1]
speed_mm_per_s = 4
[cutting]
[record]
[goal]
shape = "box"
size_mm = [1.4, 1.0, 1.4]
position_mm = [0, 0, 0.6]
[assessment]
depth_mm = [1.1, 1.5]
isthmus_mm = [0.9, 1.2]
)";

std::string scene_to(const std::string& deepest_mm) {
  std::string scene = kSunkBurr;
  scene.insert(scene.find("speed_mm_per_s"), "points_mm = [[0, 0, 1.2], [0, 0, " + deepest_mm +
                                                 "], [0.2, 0, " + deepest_mm + "], [0, 0, 1.4]]\n");
  return scene;
}

/// Tells what the view holds, and how many pixels differ between its states.
constexpr const char* kDriver = R"(
const v = window.sulcusView, told = {};
const differ = (a, b) => {
  let count = 0;
  for (let i = 0; i < a.rgba.length; i += 4) {
    count += Math.abs(a.rgba[i] - b.rgba[i]) + Math.abs(a.rgba[i + 1] - b.rgba[i + 1]) > 24;
  }
  return count / (a.rgba.length / 4);
};
const ground = p => {
  let count = 0;
  for (let i = 0; i < p.rgba.length; i += 4) {
    count += p.rgba[i] === 0xdf && p.rgba[i + 1] === 0xe4 && p.rgba[i + 2] === 0xea;
  }
  return count / (p.rgba.length / 4);
};
const slide = step => {
  v.slider.value = step;
  v.slider.dispatchEvent(new Event('input'));
  return v.pixels();
};
const text = name => document.querySelector(name).textContent;
const colour = name => {
  const list = document.querySelector('.colour');
  list.value = name;
  list.dispatchEvent(new Event('change'));
  return v.pixels();
};
told.heading = text('h1');
told.colourings = [...document.querySelectorAll('.colour option')].map(o => o.value);
told.scale = v.shared.range.value;
told.letters = [...document.querySelectorAll('.side-letter')].map(e => e.textContent);
const goal = v.pixels(), order = colour('order'), depth = colour('depth'), tissue = colour('tissue');
told.legend = text('.legend');
told.ground = ground(tissue);
told.goalAgainstTissue = differ(goal, tissue);
told.orderAgainstDepth = differ(order, depth);
v.turning.lookFrom(-90, 90);
told.steps = v.steps;
const last = slide(v.steps), first = slide(0);
told.firstAgainstLast = differ(first, last);
told.again = differ(slide(v.steps), last);
v.setShown('plan', true);
told.plan = differ(v.pixels(), last);
v.setShown('plan', false);
told.pins = v.pins.map(p => ({name: p.name, time: p.time_s, attempt: p.attempt}));
told.jumped = v.pins.map(pin => {
  (pin.mark || pin.row).click();
  const scene = v.scenes[pin.attempt];
  return scene.attempt.moments[scene.moment].time_s;
});
if (v.pins.length) told.output = text('.slide output');
document.querySelector('figure img')?.click();
told.enlarged = document.querySelector('dialog')?.open;
told.curve = document.querySelector('.curve .now').getAttribute('transform');
told.markup = document.querySelectorAll('body b:not(.pins b)').length;
told.requests = performance.getEntriesByType('resource').map(e => e.name)
    .filter(name => !name.startsWith('data:'));
)";
/// What a page that something leaves would ask for.
constexpr const char* kLeaver = R"(
const refused = [];
addEventListener('securitypolicyviolation', e => refused.push(e.effectiveDirective));
for (const tag of ['img', 'script', 'iframe']) {
  const element = document.createElement(tag);
  element.src = 'http://127.0.0.1:9/x';
  document.body.append(element);
}
fetch('http://127.0.0.1:9/x').catch(() => {});
const wait = setInterval(() => {
  if (refused.length < 4) return;
  clearInterval(wait);
  told.refused = refused.sort();
  tell();
}, 50);
)";

class Page : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null") != 0) {
      GTEST_SKIP() << "chromium is not installed";
    }
  }
  std::string run(const std::string& name, const std::string& scene) {
    const auto result = test::sulcus_command(
        "run " + scratch_.write(name + ".toml", scene) + " -o " + scratch_.path(name),
        scratch_.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return scratch_.path(name) + "/recording.h5";
  }
  test::CommandResult browse(const std::string& page, const std::string& options) {
    return test::program_command(
        "chromium",
        "--headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader "
        "--window-size=1000,700 --virtual-time-budget=3000 --enable-logging=stderr "
        "--disable-background-networking --user-data-dir=" +
            scratch_.path("browser") + " " + options + " file://" + page,
        scratch_.path("said"));
  }
  /// What the driver tells of a page. `said`: lines of the console.
  json drive(const std::string& page, const std::string& more, std::string* said) {
    const std::string driven = scratch_.write(
        "driven.html", test::read_file(page) +
                           "<script>const tell = () => { const pre = "
                           "document.createElement('pre'); pre.id = 'told'; pre.textContent = "
                           "btoa(unescape(encodeURIComponent(JSON.stringify(told)))); "
                           "document.body.append(pre); };" +
                           kDriver + more + "</script>");
    const auto result = browse(driven, "--dump-dom");
    EXPECT_EQ(result.status, 0) << result.err;
    for (std::size_t at = result.err.find(":CONSOLE"); at != std::string::npos;
         at = result.err.find(":CONSOLE", at + 1)) {
      const std::string line = result.err.substr(at, result.err.find('\n', at) - at);
      // Chromium's advice on reading pixels back, which the driver does and the page does not.
      if (line.find("ReadPixels") == std::string::npos) *said += line + "\n";
    }
    const std::string mark = "<pre id=\"told\">";
    const std::size_t begin = result.out.find(mark);
    if (begin == std::string::npos) {
      ADD_FAILURE() << "the driver did not end: " << result.err;
      return {};
    }
    const std::string coded = result.out.substr(
        begin + mark.size(), result.out.find('<', begin + 1) - begin - mark.size());
    return json::parse(
        test::program_command("sh", "-c 'echo " + coded + " | base64 -d'", scratch_.path("err"))
            .out);
  }
  const ScratchFolder scratch_;
};

TEST_F(Page, OfARunShowsItOverTimeAndAgainstItsPlan) {
  const std::string page = scratch_.path("review.html");
  const auto made = test::sulcus_command(
      "render " + run("deep", scene_to("0.2")) + " --review " + page, scratch_.path("err"));
  ASSERT_EQ(made.status, 0) << made.err;
  std::string console;
  const json told = drive(page, "tell();", &console);
  EXPECT_EQ(console, "");
  EXPECT_EQ(told["heading"], "</script><b>\"a\" & b</b><!--");
  EXPECT_EQ(told["markup"], 0);
  EXPECT_EQ(told["colourings"], json::parse(R"(["tissue", "goal", "depth", "order"])"));
  EXPECT_EQ(told["scale"], 0.5);
  EXPECT_EQ(told["letters"], json::parse(R"(["M", "L", "D", "B"])"));
  EXPECT_EQ(told["legend"], "enamel");
  EXPECT_GT(told["ground"], 0.2);  // the block takes a part of the view, not all of it
  EXPECT_LT(told["ground"], 0.9);
  EXPECT_GT(told["goalAgainstTissue"], 0.01);
  EXPECT_GT(told["orderAgainstDepth"], 0.002);
  EXPECT_GT(told["steps"], 5);
  EXPECT_GT(told["firstAgainstLast"], 0.01);
  EXPECT_EQ(told["again"], 0.0);
  EXPECT_GT(told["plan"], 0.01);
  ASSERT_EQ(told["pins"].size(), 1u) << told["pins"];
  EXPECT_EQ(told["pins"][0]["name"], "depth_mm");
  EXPECT_NEAR(told["jumped"][0].get<double>(), told["pins"][0]["time"].get<double>(), 1e-9);
  EXPECT_EQ(told["enlarged"], true);
  EXPECT_EQ(told["requests"], json::array());
  EXPECT_NE(told["curve"], nullptr);
}

TEST_F(Page, IsThereOnceItIsOpened) {
  const std::string page = scratch_.path("review.html"), picture = scratch_.path("page.png");
  ASSERT_EQ(test::sulcus_command("render " + run("deep", scene_to("0.2")) + " --review " + page,
                                 scratch_.path("err"))
                .status,
            0);
  browse(page, "--screenshot=" + picture);
  const Image image = test::read_png(picture);
  std::set<int> colours;  // of the view, which begins below the heading
  for (int y = 150; y < 450; y += 3) {
    for (int x = 60; x < 600; x += 3) {
      const std::size_t at = 3 * (static_cast<std::size_t>(y) * image.width + x);
      colours.insert(image.rgb[at] << 16 | image.rgb[at + 1] << 8 | image.rgb[at + 2]);
    }
  }
  EXPECT_GT(colours.size(), 100u) << "shaded colours of the block and of the error";
}

TEST_F(Page, ComparesTwoAttemptsInOneCameraAndLetsNothingOut) {
  const std::string folder = scratch_.path("compared");
  const auto made = test::sulcus_command("assess " + run("shallow", scene_to("0.2")) + " " +
                                             run("right", scene_to("-0.4")) + " -o " + folder,
                                         scratch_.path("err"));
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find(folder + "/comparison.html"), std::string::npos);
  const std::string page = folder + "/comparison.html";
  EXPECT_NE(test::read_file(page).find("Attempt 2 is better: attempt 1 has 50 of 100, attempt 2 "
                                       "has 100 of 100"),
            std::string::npos);
  std::string console;
  const json told = drive(page, kLeaver, &console);
  EXPECT_EQ(told["letters"].size(), 8u);
  EXPECT_GT(told["firstAgainstLast"], 0.01);
  ASSERT_EQ(told["pins"].size(), 1u);
  EXPECT_EQ(told["pins"][0]["attempt"], 0);
  EXPECT_NEAR(told["jumped"][0].get<double>(), told["pins"][0]["time"].get<double>(), 1e-9);
  EXPECT_EQ(told["refused"],
            json::parse(R"(["connect-src", "frame-src", "img-src", "script-src-elem"])"));
}

TEST_F(Page, OfEqualMarksTheNearerIsBetter) {
  const std::string nearer = run("nearer", scene_to("0.2")), off = run("off", scene_to("0.3"));
  const auto verdict_of = [&](const std::string& attempts) {
    const std::string folder = scratch_.path("equal_" + std::to_string(attempts.size()));
    const auto made =
        test::sulcus_command("assess " + attempts + " -o " + folder, scratch_.path("err"));
    EXPECT_EQ(made.status, 0) << made.err;
    const std::string page = test::read_file(folder + "/comparison.html");
    const std::size_t begin = page.find("<p class=\"mark\">");
    return page.substr(begin, page.find("</p>", begin) - begin);
  };
  EXPECT_NE(verdict_of(off + " " + nearer)
                .find("Attempt 2 is better, nearer than its equals in 1 "
                      "measure: attempt 1 has 50 of 100, attempt 2 has "
                      "50 of 100"),
            std::string::npos);
  EXPECT_NE(verdict_of(nearer + " " + nearer).find("No one is better"), std::string::npos);
  // Nearer than both in depth, but with a lesser mark.
  std::string narrow = scene_to("0.1");
  const std::string diameter = "diameter_mm = 1.0";
  narrow.replace(narrow.find(diameter), diameter.size(), "diameter_mm = 0.7");
  const std::string lesser = run("lesser", narrow);
  EXPECT_NE(verdict_of(lesser + " " + off + " " + nearer).find("Attempt 3 is better"),
            std::string::npos);
}

TEST_F(Page, WithoutThreeJsThePackageIsNamed) {
  const std::string recording = run("deep", scene_to("0.2"));
  const auto refused = test::sulcus_command(
      "render " + recording + " --review " + scratch_.path("r.html"), scratch_.path("err"),
      "SULCUS_CACHE=off SULCUS_THREE_JS=" + scratch_.path("none.js"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err_lines(), 1) << refused.err;
  EXPECT_NE(refused.err.find("libjs-three"), std::string::npos) << refused.err;
  const auto assessed = test::sulcus_command(
      "assess " + recording + " " + recording + " -o " + scratch_.path("both"),
      scratch_.path("err"), "SULCUS_CACHE=off SULCUS_THREE_JS=" + scratch_.path("none.js"));
  EXPECT_EQ(assessed.status, 0) << "what was measured is told all the same";
  EXPECT_NE(assessed.err.find("comparison.html was not written"), std::string::npos);
}

}  // namespace
}  // namespace sulcus::page_test
