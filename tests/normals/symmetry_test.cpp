#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/normals/normal_method.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus::symmetry_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// A symmetry of the grid: component a of what it makes is sign[a] times component from[a] of what
/// it is given.
struct Symmetry {
  std::array<int, 3> from, sign;

  Vector3f of(const Vector3f& v) const {
    Vector3f turned;
    for (std::size_t a = 0; a < 3; ++a) {
      turned[static_cast<int>(a)] = static_cast<float>(sign[a]) * v[from[a]];
    }
    return turned;
  }
  /// Of a voxel in a grid of so many cells to each side.
  Cell of(const Cell& c, int edge) const {
    Cell turned;
    for (std::size_t a = 0; a < 3; ++a) {
      turned[static_cast<int>(a)] = sign[a] > 0 ? c[from[a]] : edge - 1 - c[from[a]];
    }
    return turned;
  }
};
std::vector<Symmetry> all_symmetries() {
  std::vector<Symmetry> all;
  std::array<int, 3> from{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      all.push_back(
          {from,
           {(signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -1 : 1, (signs & 4) != 0 ? -1 : 1}});
    }
  } while (std::ranges::next_permutation(from).found);
  return all;
}

constexpr int kEdge = 32;

struct Shape {
  std::string name;
  VoxelModel model;
};

template <class Solid>
VoxelModel model_of(const Solid& solid) {
  return test::make_model(Eigen::Vector3i::Constant(kEdge), 1e-4, [&](const Cell& c) {
    // Away from the faces of the grid, so that no surface is cut there.
    if ((c.array() < 2).any() || (c.array() > kEdge - 3).any()) return false;
    const Vector3d centre = c.cast<double>().array() - 0.5 * (kEdge - 1);
    return solid(c, centre);
  });
}

std::vector<Shape> shapes() {
  std::vector<Shape> all;
  const auto add = [&](const char* name, const auto& solid) {
    all.push_back({name, model_of(solid)});
  };
  add("box", [](const Cell& c, const Vector3d&) {
    return (c.array() >= Cell(5, 8, 4).array()).all() &&
           (c.array() < Cell(25, 22, 27).array()).all();
  });
  add("cube", [](const Cell&, const Vector3d& p) { return p.cwiseAbs().maxCoeff() < 9.0; });
  add("blob", [](const Cell&, const Vector3d& p) {
    const double wave = std::sin(0.41 * p.x() + 0.3) + std::sin(0.37 * p.y() + 1.1 + 0.1 * p.x()) +
                        std::sin(0.33 * p.z() - 0.5 + 0.15 * p.y());
    return p.norm() < 10.0 + 2.0 * wave;
  });
  add("ball", [](const Cell&, const Vector3d& p) { return p.norm() < 11.3; });
  add("groove", [](const Cell&, const Vector3d& p) {
    const double across = 0.8 * p.x() + 0.6 * p.y() + 0.31;
    return p.norm() < 13.0 && (p.z() < 5.2 && p.z() < 1.3 * std::abs(across) - 4.0);
  });
  add("straight groove", [](const Cell&, const Vector3d& p) {
    return p.z() < 8.0 && p.z() < 1.7 * std::abs(p.x()) - 3.0;
  });
  add("tilted plane", [](const Cell&, const Vector3d& p) {
    return p.norm() < 14.0 && Vector3d(0.36, -0.48, 0.8).dot(p) < 1.7;
  });
  add("planes of 45 degrees", [](const Cell&, const Vector3d& p) {
    return p.x() + p.y() < 4.5 && p.z() < 7.1 && p.y() - p.z() < 9.2;
  });
  add("diagonal edges", [](const Cell&, const Vector3d& p) {
    return std::abs(p.x()) + std::abs(p.y()) + std::abs(p.z()) < 14.0;
  });
  add("roof", [](const Cell&, const Vector3d& p) {
    return std::abs(p.x()) + p.z() < 5.1 && std::abs(p.y()) < 12.0;
  });
  add("thin tilted plate", [](const Cell&, const Vector3d& p) {
    return std::abs(Vector3d(0.51, 0.2, 0.84).normalized().dot(p)) < 0.8;
  });
  add("tilted box", [](const Cell&, const Vector3d& p) {
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(0.5, Vector3d::UnitY()) * Eigen::AngleAxisd(0.3, Vector3d::UnitX()))
            .toRotationMatrix();
    return ((turn.transpose() * p).cwiseAbs().array() < 8.2).all();
  });
  std::mt19937 random(7);
  std::vector<bool> noise(kEdge * kEdge * kEdge);
  for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = random() % 8 < 5;
  add("noise", [&](const Cell& c, const Vector3d& p) {
    return p.norm() < 9.0 &&
           noise[static_cast<std::size_t>(c.x() + kEdge * (c.y() + kEdge * c.z()))];
  });
  return all;
}

struct Differences {
  long compared = 0, apart = 0, undefined = 0;
  float most = 0.0f;  // of normals' components and offsets
};

constexpr float kSame = 1e-6f;

// Under sanitizers each shape is turned by some of the symmetries, others from shape to shape; the
// optimised build, of which sulcus_measured_tests is, takes all.
#ifdef SULCUS_SANITIZED
constexpr std::size_t kEvery = 7;
#else
constexpr std::size_t kEvery = 1;
#endif

/// How far the estimates of a shape's surface voxels, turned, are from those of the shape turned.
/// `shape`: its number, from 0.
Differences differences_of(const VoxelModel& model, const NormalSettings& settings, bool with_hint,
                           std::size_t shape) {
  const Workpiece workpiece(VoxelModel{model});
  std::vector<VoxelQuery> queries;
  for (const Cell& c : test::surface_cells(workpiece)) {
    VoxelQuery query{c, Vector3f::Zero()};
    if (with_hint) {
      const double k = static_cast<double>(queries.size());
      query.outward = Vector3d(std::sin(k), std::sin(2.3 * k), std::cos(1.7 * k)).cast<float>();
    }
    queries.push_back(query);
  }
  std::vector<SurfaceEstimate> estimates(queries.size()), turned(queries.size());
  estimate_surfaces(workpiece, queries, settings, estimates);
  Differences differences;
  const std::vector<Symmetry> symmetries = all_symmetries();
  for (std::size_t i = shape % kEvery; i < symmetries.size(); i += kEvery) {
    const Symmetry& symmetry = symmetries[i];
    const auto level = [&](const Cell& c) {
      // Where the symmetry brings it from.
      Cell from;
      for (std::size_t a = 0; a < 3; ++a) {
        const int at = c[static_cast<int>(a)];
        from[symmetry.from[a]] = symmetry.sign[a] > 0 ? at : kEdge - 1 - at;
      }
      return model.level(from);
    };
    const Workpiece other(model.fills ? test::filled_model(model.grid.cells, 1e-4, level)
                                      : test::make_model(model.grid.cells, 1e-4, level));
    std::vector<VoxelQuery> others;
    for (const VoxelQuery& query : queries) {
      others.push_back({symmetry.of(query.voxel, kEdge), symmetry.of(query.outward)});
    }
    estimate_surfaces(other, others, settings, turned);
    for (std::size_t k = 0; k < queries.size(); ++k) {
      ++differences.compared;
      if (turned[k].defined != estimates[k].defined) {
        ++differences.undefined;
        continue;
      }
      const float most =
          std::max((turned[k].normal - symmetry.of(estimates[k].normal)).cwiseAbs().maxCoeff(),
                   std::abs(turned[k].offset - estimates[k].offset));
      differences.apart += most > kSame ? 1 : 0;
      differences.most = std::max(differences.most, most);
    }
  }
  return differences;
}

class NormalSymmetryTest : public ::testing::TestWithParam<NormalMethod> {};
INSTANTIATE_TEST_SUITE_P(Methods, NormalSymmetryTest,
                         ::testing::Values(NormalMethod::kLdm, NormalMethod::kLdmFast),
                         [](const auto& method) {
                           return std::string(
                               kNormalMethodNames[static_cast<std::size_t>(method.param)]);
                         });

/// A shape with the share of each voxel that lies in it, by 6 x 6 x 6 points; and so cut along a
/// groove, that its floor is rough.
std::vector<Shape> filled_shapes() {
  std::vector<Shape> all;
  const auto add = [&](const char* name, const auto& solid) {
    all.push_back(
        {name, test::filled_model(Eigen::Vector3i::Constant(kEdge), 1e-4, [&](const Cell& c) {
           if ((c.array() < 2).any() || (c.array() > kEdge - 3).any()) return 0;
           int inside = 0;
           for (int n = 0; n < 216; ++n) {
             const Vector3d in(n % 6, n / 6 % 6, n / 36);
             const Vector3d p =
                 c.cast<double>().array() - 0.5 * (kEdge - 1) + (in.array() - 2.5) / 6.0;
             inside += solid(p) ? 1 : 0;
           }
           return (inside * kFullLevel + 108) / 216;
         })});
  };
  add("filled ball", [](const Vector3d& p) { return p.norm() < 11.3; });
  add("filled cube", [](const Vector3d& p) { return p.cwiseAbs().maxCoeff() < 9.3; });
  add("filled plane",
      [](const Vector3d& p) { return p.norm() < 14.0 && Vector3d(0.36, -0.48, 0.8).dot(p) < 1.7; });
  add("filled diagonals",
      [](const Vector3d& p) { return std::abs(p.x()) + std::abs(p.y()) + std::abs(p.z()) < 14.2; });
  add("filled groove", [](const Vector3d& p) {
    return p.norm() < 13.0 && (p - Vector3d(2.0, 0.3, 9.0)).tail<2>().norm() > 4.7;
  });
  std::mt19937 random(3);
  all.push_back(all.back());
  all.back().name = "rough groove";
  VoxelModel& rough = all.back().model;
  for (const Cell& c : test::solid_cells(rough)) {
    const FillLevel level = rough.level(c);
    if (level < kFullLevel) rough.set_level(c, static_cast<FillLevel>(1 + random() % level));
  }
  return all;
}

TEST_P(NormalSymmetryTest, NormalsOfFractionsTurnWithTheShape) {
  std::size_t number = 0;
  for (const Shape& shape : filled_shapes()) {
    const Differences d = differences_of(
        shape.model, {.normals = GetParam(), .neighbourhood = 6, .trace = 12}, false, number++);
    std::printf("%-20s %6ld of %7ld apart, by up to %.2g, undefined %ld\n", shape.name.c_str(),
                d.apart, d.compared, static_cast<double>(d.most), d.undefined);
    EXPECT_EQ(d.undefined, 0) << shape.name;
    EXPECT_EQ(d.apart, 0) << shape.name << ", by up to " << d.most;
  }
}

TEST_P(NormalSymmetryTest, NormalsTurnWithTheShape) {
  std::size_t number = 0;
  for (const Shape& shape : shapes()) {
    for (const int neighbourhood : {6, 10}) {
      for (const bool with_hint : {false, true}) {
        const Differences d = differences_of(
            shape.model, {.normals = GetParam(), .neighbourhood = neighbourhood, .trace = 12},
            with_hint, number++);
        std::printf("%-20s NS %2d hint %d: %6ld of %7ld apart, by up to %.2g, undefined %ld\n",
                    shape.name.c_str(), neighbourhood, with_hint ? 1 : 0, d.apart, d.compared,
                    static_cast<double>(d.most), d.undefined);
        EXPECT_EQ(d.undefined, 0) << shape.name << ", NS " << neighbourhood;
        EXPECT_EQ(d.apart, 0) << shape.name << ", NS " << neighbourhood << ", by up to " << d.most;
      }
    }
  }
}

}  // namespace
}  // namespace sulcus::symmetry_test
