#include "haptics/contact/contact_kernels.hpp"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/instruction_sets.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::contact_kernels_test {
namespace {

constexpr double kVoxel = 50e-6;

/// The kernels of each instruction set against the plain ones.
class ContactKernelsTest : public ::testing::TestWithParam<InstructionSet> {
 protected:
  ContactKernelsTest() : burr_(make_burr(test::small_burr(), kVoxel)), grid_{{64, 64, 64}, kVoxel} {
    pose_ =
        test::pose_along({0.2e-3, -0.1e-3, 0.15e-3}, Eigen::Vector3d(0.3, -0.5, 1).normalized());
  }
  void SetUp() override {
    fast_ = contact_kernels_of(GetParam());
    if (!fast_) GTEST_SKIP() << "this processor has no " << test::set_name(GetParam());
  }

  /// Voxels all over the grid: inside the burr, beside it, and beyond its field's box.
  std::vector<std::uint32_t> keys(std::size_t count) {
    std::vector<std::uint32_t> all(count);
    for (std::uint32_t& key : all) {
      key = voxel_key(static_cast<int>(random_() % 64), static_cast<int>(random_() % 64),
                      static_cast<int>(random_() % 64));
    }
    return all;
  }

  /// Contacts with and without normals, facing the burr and away from it.
  struct Both {
    explicit Both(std::size_t count) : contacts(count) {}
    Contacts contacts;
    ContactBlock block;
  };
  Both contacts(std::size_t count) {
    Both all(count);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    for (const std::uint32_t key : keys(count)) {
      Contact contact;
      contact.cell = cell_of_key(key);
      contact.tissue = static_cast<std::uint8_t>(key % 3);
      const std::size_t i = all.contacts.size();
      all.block.set_end(i + 1);
      all.block(ContactBlock::kDistance)[i] = 60e-6f * unit(random_);
      all.block(ContactBlock::kOffset)[i] = 0.0f;
      if (key % 7 != 0) {
        contact.normal = Eigen::Vector3f(unit(random_), unit(random_), unit(random_)).normalized();
        all.block(ContactBlock::kOffset)[i] = 30e-6f * unit(random_);
      }
      all.contacts.push_back(contact);
    }
    return all;
  }
  /// `turn`: whether what forces turn to has been told.
  static void expect_equal(const Contacts& a, const Contacts& b, bool turn) {
    for (std::size_t q = 0; q < Contacts::kQuantities; ++q) {
      if (!turn && q >= Contacts::kToolNormal && q < Contacts::kToolNormal + 3) continue;
      ASSERT_EQ(std::memcmp(a(q), b(q), a.size() * sizeof(float)), 0) << "quantity " << q;
    }
  }

  Burr burr_;
  VoxelGrid grid_;
  Pose pose_;
  std::mt19937 random_{11};
  const ContactKernels* const plain_ = contact_kernels_of(InstructionSet::kPlain);
  const ContactKernels* fast_ = nullptr;
};
INSTANTIATE_TEST_SUITE_P(Sets, ContactKernelsTest, test::fast_sets(), test::set_of);

TEST_P(ContactKernelsTest, DistancesAreTheFieldsInEverySet) {
  const ContactFrame frame(grid_, burr_.field, pose_, 0.0);
  const std::vector<std::uint32_t> all = keys(4000);
  std::vector<float> distance[2], outward[2][3], leaf[2];
  const ContactKernels* const sets[2] = {plain_, fast_};
  for (int s = 0; s < 2; ++s) {
    distance[s].resize(all.size() + Contacts::kGroup), leaf[s].resize(all.size());
    for (auto& axis : outward[s]) axis.resize(all.size() + Contacts::kGroup);
    float* const to[3] = {outward[s][0].data(), outward[s][1].data(), outward[s][2].data()};
    // All, and then the near ones alone: the same, in the same order.
    std::vector<std::uint32_t> to_keys(all.size() + Contacts::kGroup),
        near_keys(all.size() + Contacts::kGroup);
    const std::size_t found = sets[s]->find_near(frame, all.data(), all.size() - 3, 1.0f,
                                                 to_keys.data(), distance[s].data(), to);
    ASSERT_EQ(found, all.size() - 3) << "not those that fill up the last group";
    to_keys.resize(found);
    ASSERT_TRUE(std::equal(to_keys.begin(), to_keys.end(), all.begin()));
    std::vector<float> near_m(all.size() + Contacts::kGroup), n0 = near_m, n1 = near_m, n2 = near_m;
    float* const near_to[3] = {n0.data(), n1.data(), n2.data()};
    const std::size_t near = sets[s]->find_near(frame, all.data(), found, 10e-6f, near_keys.data(),
                                                near_m.data(), near_to);
    std::size_t n = 0;
    for (std::size_t k = 0; k < found; ++k) {
      if (!(distance[s][k] < 10e-6f)) continue;
      ASSERT_EQ(near_keys[n], all[k]);
      ASSERT_EQ(near_m[n], distance[s][k]);
      ASSERT_EQ(n2[n], outward[s][2][k]);
      ++n;
    }
    ASSERT_EQ(near, n);
    distance[s].resize(found);
    for (auto& axis : outward[s]) axis.resize(found);
    sets[s]->leaf_distances(frame, all.data(), all.size(), leaf[s].data());
  }
  EXPECT_EQ(distance[0], distance[1]);
  EXPECT_EQ(leaf[0], leaf[1]);
  int inside = 0, outside = 0;
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(outward[0][axis], outward[1][axis]);
  for (std::size_t k = 0; k < distance[0].size(); ++k) {
    const Eigen::Vector3d centre = grid_.centre_world(cell_of_key(all[k]));
    const Eigen::Vector3f p =
        burr_.field.field_from_tool(pose_.inverse_point(centre)).cast<float>();
    Eigen::Vector3f gradient;
    const float expected_m = burr_.field.sample_with_gradient(p, gradient);
    ASSERT_NEAR(distance[0][k], expected_m, 3e-9);
    (expected_m < 0 ? inside : outside) += 1;
    const Eigen::Vector3d away = pose_.direction(gradient.cast<double>());
    const Eigen::Vector3d found(outward[0][0][k], outward[0][1][k], outward[0][2][k]);
    // On a cell's face the gradient jumps.
    ASSERT_LT((found + away).norm(), 0.2) << k;
    // What a leaf is passed over by is a bound from below.
    const Eigen::Vector3d middle = centre + Eigen::Vector3d::Constant(3.5 * kVoxel);
    const float at_middle_m =
        burr_.field.sample(burr_.field.field_from_tool(pose_.inverse_point(middle)).cast<float>());
    ASSERT_LT(leaf[0][k], at_middle_m + 3e-9);
  }
  EXPECT_GT(inside, 40);
  EXPECT_GT(outside, 400);
}

TEST_P(ContactKernelsTest, ForcesAreTheSameBitForBit) {
  const ContactFrame frame(grid_, burr_.field, pose_, burr_.reference_m);
  const float stiffness[3] = {30e3f, 5e3f, 800.0f};
  for (const std::size_t count : {1u, 7u, 8u, 9u, 1000u}) {
    const auto seed = static_cast<std::uint32_t>(random_());
    for (const bool at_surface : {false, true}) {
      for (const bool cutting : {false, true}) {
        random_.seed(seed);
        Both a = contacts(count);
        random_.seed(seed);
        Both b = contacts(count);
        const ForceSettings settings{at_surface, at_surface, 0.2f, cutting ? 2e-4f : 0.0f};
        MeasureLanes lanes_a, lanes_b;
        plain_->measure(frame, settings, arrays_of(a.contacts), arrays_of(a.block, 0), lanes_a);
        fast_->measure(frame, settings, arrays_of(b.contacts), arrays_of(b.block, 0), lanes_b);
        const MeasureSums measured_a = sums_of(lanes_a), measured_b = sums_of(lanes_b);
        ASSERT_EQ(measured_a.weights, measured_b.weights);
        ASSERT_EQ(measured_a.counted, measured_b.counted);
        const NormalSpread &spread_a = measured_a.spread, &spread_b = measured_b.spread;
        ASSERT_EQ(std::memcmp(&spread_a, &spread_b, sizeof spread_a), 0);
        if (count == 1000) {
          ASSERT_EQ(spread_a.weight > 0.0, at_surface && cutting);
        }
        expect_equal(a.contacts, b.contacts, at_surface && cutting);
        ForceTerms terms;
        terms.blend_normals = at_surface && cutting;
        std::ranges::copy(std::array{0.9f, 0.1f, -0.05f, 0.3f, 0.0f, 0.6f}, terms.edge_blend);
        terms.stiffness_N_per_m = stiffness;
        terms.cutting = cutting;
        terms.with_stiffness = count != 1000u || cutting;
        terms.axis_m[2] = 0.04f;
        terms.linear[0] = 0.01f;
        terms.turning[2] = 700.0f;
        terms.tangential_ratio = 0.3f;
        terms.friction_speed_m_per_s = 0.01f;
        ForceSums sums_a, sums_b;
        plain_->forces(frame, terms, arrays_of(a.contacts), sums_a);
        fast_->forces(frame, terms, arrays_of(b.contacts), sums_b);
        ASSERT_EQ(std::memcmp(&sums_a, &sums_b, sizeof sums_a), 0);
        expect_equal(a.contacts, b.contacts, at_surface && cutting);
      }
    }
  }
}

TEST_P(ContactKernelsTest, WhatFillsUpTheLastGroupIsNoContact) {
  // Its key is that of the grid's first voxel: the burr is there, its one contact far from it.
  const Pose at_first{grid_.centre_world(Cell::Zero()), pose_.orientation};
  const ContactFrame frame(grid_, burr_.field, at_first, burr_.reference_m);
  for (const ContactKernels* kernels : {plain_, fast_}) {
    for (const bool at_surface : {false, true}) {
      Both one(1);
      Contact far;
      far.cell = Cell::Constant(60);
      one.contacts.push_back(far);
      one.block.set_end(1);
      one.block(ContactBlock::kDistance)[0] = 1e-3f;
      MeasureLanes lanes;
      kernels->measure(frame, ForceSettings{at_surface, at_surface, 0.2f, 0.0f},
                       arrays_of(one.contacts), arrays_of(one.block, 0), lanes);
      const MeasureSums measured = sums_of(lanes);
      EXPECT_EQ(measured.counted, 0u) << kernels->name;
      EXPECT_EQ(measured.weights, 0.0) << kernels->name;
    }
  }
}

}  // namespace
}  // namespace sulcus::contact_kernels_test
