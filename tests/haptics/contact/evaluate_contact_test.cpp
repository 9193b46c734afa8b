#include "haptics/contact/evaluate_contact.hpp"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/fault.hpp"
#include "engine/normals/normal_method.hpp"
#include "tests/haptics/contact/contact_stages.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::evaluate_contact_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;

class EvaluateContact : public ::testing::Test {
 protected:
  EvaluateContact()
      : workpiece_([] {
          VoxelModel model = test::two_balls();
          model.grid.voxel_m = kVoxel;
          return model;
        }()),
        burr_(make_burr(test::small_burr(), kVoxel)),
        scratch_(settings_) {}

  ContactResult evaluate(const Pose& pose, const Twist* twist = nullptr) {
    return evaluate_contact(workpiece_,
                            {burr_, pose, tissues_, settings_, twist, Outputs::kForceAndStiffness},
                            scratch_);
  }
  /// Everything a caller sees of an evaluation.
  struct Seen {
    Wrench wrench;
    Matrix6d stiffness;
    std::uint32_t contacts, tested, leaves, faults;
    std::vector<std::uint32_t> voxels;
    std::vector<double> forces_N, powers_W;
    bool operator==(const Seen& o) const {
      return wrench.force_N == o.wrench.force_N && wrench.torque_Nm == o.wrench.torque_Nm &&
             stiffness == o.stiffness && contacts == o.contacts && tested == o.tested &&
             leaves == o.leaves && faults == o.faults && voxels == o.voxels &&
             forces_N == o.forces_N && powers_W == o.powers_W;
    }
  };
  Seen see(const Pose& pose, const Twist* twist = nullptr) {
    const ContactResult r = evaluate(pose, twist);
    Seen seen{r.wrench, r.stiffness, r.contacts, r.tested, r.leaves, r.faults, {}, {}, {}};
    for (const Contact contact : scratch_.contacts) {
      seen.voxels.push_back(contact.key());
      seen.forces_N.push_back(contact.normal_force_N);
      seen.powers_W.push_back(contact.power_W);
    }
    return seen;
  }
  std::vector<ChildStatus> statuses() const {
    std::vector<ChildStatus> all;
    const Octree& tree = workpiece_.octree();
    const int last = tree.levels() - 1;
    const std::uint32_t end = tree.index({last, tree.dims(last).array() - 1});
    for (std::uint32_t i = 0; i <= end; ++i) all.push_back(tree.node(i).status);
    return all;
  }

  Workpiece workpiece_;
  Burr burr_;
  std::vector<TissueSettings> tissues_ = test::one_tissue();
  HapticsSettings settings_;
  ContactScratch scratch_;
  const Pose in_ = test::pose_along({0.1e-3, 0.2e-3, 0.3e-3}, Vector3d(0.3, 0.5, 1).normalized());
  const Pose elsewhere_ = test::upright({-0.3e-3, -0.2e-3, 0.4e-3});
  const Twist twist_{Vector3d(1e-3, 2e-3, 0), Vector3d(0, 0.1, 0), burr_.speed_rad_per_s};
};

TEST_F(EvaluateContact, CallingItAnyNumberOfTimesChangesNothing) {
  // With nodes that a traversal could switch off.
  for (const Cell& c : test::solid_cells(workpiece_.model())) {
    if (c.x() >= 16 && c.x() < 32 && c.y() >= 16 && c.y() < 32 && c.z() >= 16 && c.z() < 32) {
      workpiece_.remove(c);
    }
  }
  const std::uint64_t hash = workpiece_.hash();
  const std::vector<ChildStatus> before = statuses();
  const Seen first = see(in_, &twist_);
  ASSERT_GT(first.contacts, 20u);
  EXPECT_FALSE(scratch_.emptied_nodes.empty());
  for (int i = 0; i < 5; ++i) {
    see(elsewhere_);
    EXPECT_TRUE(see(in_, &twist_) == first) << "call " << i;
  }
  EXPECT_EQ(workpiece_.hash(), hash);
  EXPECT_EQ(statuses(), before);
}

TEST_F(EvaluateContact, AFreshScratchGivesTheSameBits) {
  see(elsewhere_);
  const Seen used = see(in_, &twist_);
  scratch_ = ContactScratch(settings_);
  EXPECT_TRUE(see(in_, &twist_) == used);
}

TEST_F(EvaluateContact, LeavesNothingBehindWhenTheToolIsGone) {
  ASSERT_GT(see(in_).contacts, 0u);
  const Seen gone = see(test::upright({0, 0, 50e-3}));
  EXPECT_EQ(gone.contacts, 0u);
  EXPECT_EQ(gone.tested, 0u);
  EXPECT_EQ(gone.leaves, 0u);
  EXPECT_TRUE(gone.voxels.empty());
  EXPECT_EQ(gone.wrench.force_N, Vector3d(0, 0, 0));
}

TEST_F(EvaluateContact, DoesNotAllocate) {
  evaluate(in_, &twist_);  // tables are made once, on first use
  settings_.normals = NormalMethod::kLdmPaper;
  evaluate(in_, &twist_);
  for (const NormalMethod method : {NormalMethod::kLdm, NormalMethod::kLdmPaper}) {
    for (const Scaling scaling : {Scaling::kNone, Scaling::kCount, Scaling::kSmooth}) {
      settings_.normals = method;
      settings_.scaling = scaling;
      const std::uint64_t before = test::allocation_count();
      const ContactResult result = evaluate(in_, &twist_);
      EXPECT_EQ(test::allocation_count(), before);
      EXPECT_GT(result.contacts, 0u);
    }
  }
}

TEST_F(EvaluateContact, KeepsTheDeepestAndSaysSoBeyondItsCapacity) {
  const Seen all = see(in_);
  settings_.max_contacts = 20;
  scratch_ = ContactScratch(settings_);
  const ContactResult few = evaluate(in_);
  EXPECT_EQ(few.faults, kFaultContactsFull);
  EXPECT_LE(few.contacts, 20u);
  EXPECT_GT(few.contacts, 10u);
  EXPECT_EQ(few.tested, all.tested);
}

/// A burr among so much surface that its contacts are found in several blocks.
class EvaluateManyContacts : public ::testing::Test {
 protected:
  EvaluateManyContacts()
      : workpiece_(test::make_model({96, 96, 96}, kVoxel,
                                    [](const Cell& c) { return c.sum() % 5 < 3 && c.z() < 60; })),
        burr_(make_burr(test::small_burr(BurrShape::kRound, 2.4e-3), kVoxel)) {
    settings_.normals = NormalMethod::kLdmFast;
  }
  ContactResult evaluate(ContactScratch& scratch, const NormalCache* kept = nullptr) const {
    return evaluate_contact(workpiece_, {burr_, pose_, tissues_, settings_}, scratch, kept);
  }
  double reach_m() const { return contact_reach_m(workpiece_, settings_.scaling, Outputs::kForce); }
  /// Voxels as the narrow phase has them, depths as the field at each contact's own surface point,
  /// and the force as their sum.
  void expect_true(const ContactResult& result, const ContactScratch& scratch,
                   const test::Found& found) const {
    EXPECT_EQ(result.tested, found.tested);
    EXPECT_GT(result.tested, 2 * ContactBlock::kVoxels);
    ASSERT_EQ(scratch.contacts.size(), found.contacts.size());
    Vector3d force_N = Vector3d::Zero(), torque_Nm = Vector3d::Zero();
    double size_N = 0.0;
    std::uint32_t counted = 0, other_normals = 0;
    const Vector3d reference = pose_.point({0.0, burr_.reference_m, 0.0});
    for (std::size_t i = 0; i < found.contacts.size(); ++i) {
      const Contact contact = scratch.contacts[i];
      ASSERT_EQ(contact.key(), found.contacts[i].key());
      const Vector3d centre = workpiece_.grid().centre_world(contact.cell);
      const Vector3d normal = contact.normal.cast<double>();
      const Vector3d at = centre + contact.along * kVoxel * normal;
      const double expected_m = settings_.scaling == Scaling::kSmooth
                                    ? -field_at(at)
                                    : -static_cast<double>(found.contacts[i].distance_m);
      ASSERT_NEAR(contact.depth_m, expected_m, 1e-8) << i;
      const SurfaceEstimate own = estimate_surface(workpiece_, contact.cell, settings_);
      other_normals += own.defined && contact.normal != own.normal ? 1 : 0;
      counted += contact.weight > 0.0f ? 1 : 0;
      const Vector3d one_N = contact.normal_force_N * normal;
      force_N += one_N;
      torque_Nm += (at - reference).cross(one_N);
      size_N += one_N.norm();
    }
    EXPECT_EQ(result.contacts, counted);
    EXPECT_GT(counted, found.contacts.size() / 4);
    EXPECT_LT(other_normals, found.contacts.size() / 4) << "but for what the tool vetoes";
    EXPECT_LT((result.wrench.force_N - force_N).norm(), 1e-6 * size_N);
    EXPECT_LT((result.wrench.torque_Nm - torque_Nm).norm(), 1e-6 * size_N * burr_.reference_m);
  }
  double field_at(const Vector3d& p_world) const {
    return burr_.field.sample(
        burr_.field.field_from_tool(pose_.inverse_point(p_world)).cast<float>());
  }

  Workpiece workpiece_;
  Burr burr_;
  std::vector<TissueSettings> tissues_ = test::one_tissue();
  HapticsSettings settings_;
  const Pose pose_ =
      test::pose_along({0.1e-3, 0.2e-3, -0.9e-3}, Vector3d(0.3, 0.5, 1).normalized());
};

TEST_F(EvaluateManyContacts, BlocksGiveTheVoxelsDepthsAndForcesOfAll) {
  for (const Scaling scaling : {Scaling::kNone, Scaling::kSmooth}) {
    settings_.scaling = scaling;
    ContactScratch scratch(settings_), narrow(settings_);
    expect_true(evaluate(scratch), scratch,
                test::collide(workpiece_, burr_, pose_, reach_m(), narrow));
  }
}

TEST_F(EvaluateManyContacts, BlocksGiveTheSameBitsWithHalfOfTheNormalsKept) {
  NormalCache kept(workpiece_.grid(), settings_);
  ContactScratch scratch(settings_), half(settings_);
  const ContactResult fresh = evaluate(scratch);
  for (std::size_t i = 0; i < scratch.contacts.size(); i += 2) {
    const Cell cell = scratch.contacts[i].cell;
    kept.keep(voxel_key(cell), estimate_surface(workpiece_, cell, settings_), 0);
  }
  const ContactResult found = evaluate(half, &kept);
  EXPECT_EQ(found.wrench.force_N, fresh.wrench.force_N);
  EXPECT_EQ(found.wrench.torque_Nm, fresh.wrench.torque_Nm);
  EXPECT_EQ(found.contacts, fresh.contacts);
  EXPECT_LT(half.queried.size(), scratch.contacts.size() * 2 / 3);
  ASSERT_EQ(half.contacts.size(), scratch.contacts.size());
  for (std::size_t i = 0; i < half.contacts.size(); ++i) {
    ASSERT_EQ(half.contacts[i].normal, scratch.contacts[i].normal);
    ASSERT_EQ(half.contacts[i].depth_m, scratch.contacts[i].depth_m);
  }
}

TEST_F(EvaluateManyContacts, OfMoreThanTheCapacityTheDeepestCount) {
  ContactScratch narrow(settings_);
  const test::Found all = test::collide(workpiece_, burr_, pose_, reach_m(), narrow);
  // Full in the first block, and after several.
  for (const std::size_t capacity : {std::size_t{500}, all.contacts.size() - 1}) {
    settings_.max_contacts = static_cast<int>(capacity);
    ContactScratch scratch(settings_), small(settings_);
    const std::uint64_t before = test::allocation_count();
    const ContactResult full = evaluate(scratch);
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(full.faults, kFaultContactsFull);
    EXPECT_EQ(scratch.contacts.size(), capacity);
    expect_true(full, scratch, test::collide(workpiece_, burr_, pose_, reach_m(), small, true));
  }
}

TEST_F(EvaluateContact, AForceThatIsNotFiniteComesOnlyFromAPoseThatIsNot) {
  // Far beyond anything a device says, and beyond single precision.
  for (const double far_m : {1.0, 1e6, 1e30, 1e300}) {
    const ContactResult result = evaluate(test::upright({far_m, -far_m, far_m}));
    EXPECT_EQ(result.contacts, 0u);
    EXPECT_EQ(result.wrench.force_N, Vector3d(0, 0, 0));
  }
}

TEST_F(EvaluateContact, ThePapersMethodFeelsTheSameTooth) {
  const Vector3d ldm = evaluate(in_).wrench.force_N;
  settings_.normals = NormalMethod::kLdmPaper;
  settings_.trace = 5;
  const Vector3d paper = evaluate(in_).wrench.force_N;
  EXPECT_LT(test::angle_deg(ldm, paper), 5.0);
}

}  // namespace
}  // namespace sulcus::evaluate_contact_test
