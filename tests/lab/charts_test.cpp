#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/user_text.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/stability/force_traces.hpp"

namespace sulcus::lab::charts_test {
namespace {

namespace fs = std::filesystem;

// That each chart's script takes the tables that its command writes, also at the ends of what can
// be measured, and that no name of a folder is more to it than a name.

class Charts : public ::testing::Test {
 protected:
  void table(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  /// Whether it was drawn, by a picture larger than an empty frame's.
  bool drawn(const std::string& chart, const std::string& subject = "") const {
    const std::string file = folder_.path("chart.png");
    fs::remove(file);
    Results results(folder_.path(""));
    return results.draw(chart, "chart", subject) && fs::file_size(file) > 5000;
  }
  std::string picture() const { return test::read_file(folder_.path("chart.png")); }

  ScratchFolder folder_;
};

TEST_F(Charts, NormalsAndTheirCost) {
  table("normals.csv",
        "method,ns,zone,voxels,mae_deg,p95_deg,max_deg,undefined,ns_per_normal,ratio_to_ldm\n"
        "ldm,3,sphere,9,0.5000,1,2,0,300.0,1.000\n"
        "ldm,6,sphere,9,0.0000,1,2,0,900.0,1.000\n"
        "exact,6,sphere,9,0.7000,1,2,0,9000.0,10.000\n"
        "exact,6,cube,9,0.7000,1,2,0,,\n"
        "ldm,6,cube,9,0.1000,1,2,0,700.0,1.000\n");
  table("normals_charts.csv",
        "chart,zone,title\nnormals,sphere,\"a, b'c\"\nnormals,cube,\"cube\"\n"
        "speed_accuracy,sphere,\"sphere\"\ncost,sphere,\"`touch run` $(touch run)\"\n");
  table("cost.csv",
        "method,ns,readouts,ns_per_normal\nldm,3,49,300.0\nldm,6,169,900.0\nexact,6,2197,9000.0\n");
  for (const char* chart : {"normals", "speed_accuracy", "cost"}) EXPECT_TRUE(drawn(chart));
}

TEST_F(Charts, FractionsWithAPanelOrBoth) {
  const std::string head = "quantity,shape,setting,binary_ns,binary,fractions_ns,fractions\n";
  const std::string normal = "normal_error_deg,\"sphere\",\"all\",104.6,0.22,720,0.0019\n";
  const std::string force = "force_grain_pct,\"side_cut\",\"939 ticks\",116700,0.2,1.02e+07,0.04\n";
  for (const std::string& rows : {normal, force, normal + force}) {
    table("fractions_times.csv", head + rows);
    EXPECT_TRUE(drawn("fractions")) << rows;
  }
}

TEST_F(Charts, ErrorsOnACt) {
  std::string rows = "quantity,truth,from,to,binary,fractions\n";
  for (const char* key : {"offset_error_voxels,through", "normal_error_deg,through",
                          "offset_error_voxels,smoothed", "normal_error_deg,smoothed"}) {
    for (const char* bin : {",0,0.02,50,0", ",0.02,0.04,50,100", ",0.04,0.06,0,0"}) {
      rows.append(key).append(bin).append("\n");
    }
  }
  table("fractions_ct.csv", rows);
  EXPECT_TRUE(drawn("fractions_ct"));
}

TEST_F(Charts, RealityWithPublishedPoints) {
  std::string rows = "against,series,x,mm3_per_s,label\n";
  for (const char* series :
       {"paper", "saturating medium", "saturating coarse", "saturating carbide"}) {
    for (const char* against : {"load_N", "speed_krpm"}) {
      for (const char* point : {"0.5,0.1", "1,0.12", "2,0.13"}) {
        rows += std::string(against) + ",\"" + series + "\"," + point + ",\"\"\n";
      }
    }
  }
  table("reality_curves.csv", rows + "load_N,\"published\",1,0.44,\"O'Hara 2011\"\n");
  EXPECT_TRUE(drawn("reality"));
}

TEST_F(Charts, ErrorTiles) {
  std::string pixels = "x,y,ldm_2,ldm_6,exact_6\n";
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      pixels += std::to_string(x) + "," + std::to_string(y);
      pixels += x < 20 ? ",nan,nan,nan\n" : ",0.5," + std::to_string(x) + ",180\n";
    }
  }
  table("errors_ball.csv", pixels);
  table("normals.csv",
        "method,ns,zone\nldm,2,all\nldm,6,all\nldm,8,all\nexact,6,all\nexact,6,near\n");
  EXPECT_TRUE(drawn("errors", "ball"));
}

TEST_F(Charts, TicksWithAndWithoutPcl) {
  const std::string found =
      "method,cache,contacts,contacts_mean,contacts_min,contacts_max,removed_per_tick,"
      "ticks_that_cut,us_p999,instructions_per_tick,pca_us,pca_to_mean,pca_to_p99\n";
  table("ticks.csv",
        "method,cache,contacts,us_mean,us_p50,us_p99,us_max\n"
        "ldm,fresh,100,50,50,60,70\nldm,kept,100,9,9,9,9\nldm,fresh,350,90,90,99,99\n"
        "ldm,kept,350,12,12,12,12\n");
  table("ticks_floor.csv",
        "cache,contacts,cells,burr_mm,depth_mm,surface_bytes,field_bytes,column_bytes,kept_bytes,"
        "record_bytes,gb_per_s,floor_us\nfresh,100,64,1,0.1,1,1,1,1,1,20,0.1\n"
        "kept,100,64,1,0.1,1,1,1,1,1,20,0.05\nfresh,350,64,1,0.1,1,1,1,1,1,20,0.3\n"
        "kept,350,64,1,0.1,1,1,1,1,1,20,0.2\n");
  std::string stages = "method,cache,contacts,stage,us_mean,us_p99\n";
  for (const char* key : {"ldm,fresh,100", "ldm,kept,100", "ldm,fresh,350", "ldm,kept,350"}) {
    for (const char* stage : {"broad_phase", "normals"}) {
      stages.append(key).append(",").append(stage).append(",2.5,3\n");
    }
  }
  table("ticks_stages.csv", stages);
  for (const char* pca : {",", "700"}) {
    std::string rows = found;
    for (const char* key :
         {"ldm,fresh,100,99", "ldm,kept,100,99", "ldm,fresh,350,351.5", "ldm,kept,350,351.5"}) {
      rows.append(key).append(",90,110,0,0,70,,").append(pca == std::string(",") ? "" : pca);
      rows += ",,\n";
    }
    table("ticks_found.csv", rows);
    EXPECT_TRUE(drawn("ticks")) << pca;
    EXPECT_TRUE(drawn("ticks_stages"));
  }
  const std::string columns = ",method,cache,contacts,contacts_mean,us_mean,us_p50,us_p99,us_max\n";
  table("ticks_cells.csv", "cells" + columns);
  table("ticks_bodies.csv",
        "bodies" + columns + "1,ldm,fresh,350,350.0,90,9,9,9\n16,ldm,fresh,350,350.0,95,9,9,9\n");
  EXPECT_TRUE(drawn("ticks_sweeps")) << "the one that there is";
}

TEST_F(Charts, TableOneWithAndWithoutATruth) {
  table("table1.csv",
        "experiment,quantity,paper,ours,exact\nprobing_smooth,ticks,,300,\ncutting,ticks,,300,\n");
  const std::string columns =
      "tick,contacts,force_N,exact_force_N,truth_force_N,torque_mNm,exact_torque_mNm,"
      "truth_torque_mNm\n";
  table("table1_probing_smooth.csv",
        columns + "0,1,0.1,0.11,0.12,1,1.1,1.2\n100,9,0.3,0.3,0.31,2,2,2.1\n");
  table("table1_cutting.csv", columns + "0,1,0.1,0.1,,1,1,\n100,9,0.3,0.3,,2,2,\n");
  EXPECT_TRUE(drawn("table1", "probing_smooth"));
  EXPECT_TRUE(drawn("table1", "cutting")) << "and nothing differs";
}

TEST_F(Charts, TheFront) {
  table(
      "pareto.csv",
      "method,ns,field_samples,tick_us,normals_us,force_error_pct,normal_error_deg,on_front,"
      "directions_error_pct,own_weights_error_pct\n"
      "ldm_fast,3,128,40,20,3,1,1,1,1\nldm_fast,3,32,38,20,3.5,1,1,1,1\n"
      "ldm,6,128,200,20,0.5,1,1,1,1\nldm,6,32,210,20,0.6,1,0,1,1\nexact,6,128,9000,1,2,1,0,1,1\n");
  EXPECT_TRUE(drawn("pareto"));
}

ForceTrace trace(ContactMethod method, std::string label, std::size_t ticks, bool with_depth) {
  ForceTrace t;
  t.case_name = "thin_wall";
  t.method = method;
  t.label = std::move(label);
  for (std::size_t i = 0; i < ticks; ++i) {
    t.force_N.push_back(0.001f * static_cast<float>(i) *
                        (method == ContactMethod::kNone ? -50 : 1));
    if (with_depth) t.depth_mm.push_back(0.0001f * static_cast<float>(i));
  }
  return t;
}

class ForceCharts : public Charts {
 protected:
  bool drawn_of(const std::vector<ForceTrace>& traces) const {
    write_force_traces(traces, folder_.path("stability_thin_wall.csv"));
    return drawn("stability_forces", "thin_wall");
  }
};

TEST_F(ForceCharts, AreDrawnTogetherAndInFrames) {
  std::vector<ForceTrace> few, many;
  for (const char* label : {"a", "b, c", "\"quoted\" \\ one", "d"}) {
    few.push_back(trace(ContactMethod::kCoupling, label, 300, true));
    many.push_back(trace(ContactMethod::kCoupling, label, 5000, false));
    many.push_back(trace(ContactMethod::kNone, label, 5000, true));
  }
  EXPECT_TRUE(drawn_of(few));
  EXPECT_TRUE(drawn_of(many));
}

TEST_F(ForceCharts, ThatAreAllNothingOrMissingAreDrawnToo) {
  std::vector<ForceTrace> traces{trace(ContactMethod::kCoupling, "none", 0, false)};
  traces.push_back(traces[0]);
  traces[1].force_N.assign(100, 0.0f);
  EXPECT_TRUE(drawn_of(traces));
  traces[1].force_N.assign(100, std::nanf(""));
  EXPECT_TRUE(drawn_of(traces));
  EXPECT_FALSE(drawn_of({}));
}

TEST_F(Charts, StabilityWithMissingAndEndlessValues) {
  const std::string frontier = "method,contacts,felt_hold_N_per_mm,felt_buzz_N_per_mm\n";
  const std::string damping = "loop,damping_N_s_per_m,largest_stable_N_per_mm\n";
  const std::string error = "method,tick_us,force_error_percent\n";
  table("stability_frontier.csv",
        frontier +
            "coupling,10,0.3,inf\ncoupling,1000,0.3,0.7\ncount,10,nan,1.5\ncount,1000,3,nan\n");
  table("stability_damping.csv",
        damping + "\"light hand, delay 0\",0,inf\n\"light hand, delay 0\",40,0\n\"firm\",0,1\n");
  table("stability_speed_error.csv", error + "coupling,30,0\nnone,20,9\n");
  for (const char* chart : {"stability_frontier", "stability_damping", "stability_speed_error"}) {
    EXPECT_TRUE(drawn(chart)) << chart;
  }
  table("stability_frontier.csv", frontier);
  table("stability_damping.csv", damping);
  table("stability_speed_error.csv", error);
  for (const char* chart : {"stability_frontier", "stability_damping", "stability_speed_error"}) {
    EXPECT_FALSE(drawn(chart)) << chart;
  }
}

TEST_F(Charts, AnErrorOfNothingLiesOnTheFramesEdge) {
  const auto picture_of = [&](const std::string& rows) {
    table("stability_speed_error.csv", "method,tick_us,force_error_percent\n" + rows);
    EXPECT_TRUE(drawn("stability_speed_error"));
    return picture();
  };
  const std::string without = "coupling,20,9\ncoupling,30,9\n";
  EXPECT_EQ(picture_of(without), picture_of(without)) << "or nothing follows from what differs";
  EXPECT_NE(picture_of(without), picture_of(without + "coupling,25,0\n"));
}

TEST_F(Charts, AFoldersNameIsNoMoreThanAName) {
  for (const char* name : {"it's \"q\" $(touch run) `touch run` @x %d \\", "|touch run",
                           "<touch run", "-", "r\xc3\xa4nder"}) {
    Results results(folder_.path(name));
    folder_.write(std::string(name) + "/stability_speed_error.csv",
                  "method,tick_us,force_error_percent\ncoupling,20,9\ncoupling,30,3\n");
    EXPECT_TRUE(results.draw("stability_speed_error", "chart")) << name;
    // Alone, as a user draws it, from the folder where it lies.
    const std::string quoted = for_shell(name);
    EXPECT_EQ(std::system(("cd " + for_shell(folder_.path("")) + " && gnuplot -c " +
                           SULCUS_SOURCE_DIR "/tools/sulcus_lab/charts/stability_speed_error.gp " +
                           quoted + " > alone.png 2> /dev/null")
                              .c_str()),
              0)
        << name;
    EXPECT_GT(fs::file_size(folder_.path("alone.png")), 5000u) << name;
  }
  EXPECT_FALSE(fs::exists(folder_.path("run")));
  EXPECT_FALSE(fs::exists("run")) << "where the tests are run";
}

}  // namespace
}  // namespace sulcus::lab::charts_test
