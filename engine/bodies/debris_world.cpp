#include "engine/bodies/debris_world.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <Eigen/Eigenvalues>
#include <btBulletDynamicsCommon.h>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

// Lengths in Bullet are millimetres: its tolerances are made for bodies of about one unit. Masses
// are milligrams.
constexpr double kLength = 1.0 / kMillimetre;
constexpr double kGravity_m_per_s2 = 9.81;     // along -z
constexpr double kDensity_kg_per_m3 = 2500.0;  // between those of dentine and enamel
// In which a body falls by no more than a contact may part before Bullet forgets it, which is a
// fiftieth of its size; at 1 ms small ones sank.
constexpr double kLongestStep_s = 0.25e-3;
constexpr double kSlow_mm_per_s = 3.0;  // below it for half a second a piece goes to sleep

constexpr int kBlockVoxels = 4;  // edge of the tooth's blocks
constexpr int kDirections = 96;  // in which a hull has its corners
constexpr double kMargin = 0.4;  // of a voxel, of a hull; it reaches to the voxels' faces

btVector3 bullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d eigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform bullet(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.orientation;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), bullet(kLength * pose.position));
}
Pose pose_of(const btTransform& t) {
  const btQuaternion q = t.getRotation();
  return {kMillimetre * eigen(t.getOrigin()), Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z())};
}

/// Directions spread over the sphere [Vogel 1979, on the sphere].
const std::array<Eigen::Vector3d, kDirections>& directions() {
  static const auto all = [] {
    std::array<Eigen::Vector3d, kDirections> made;
    for (int i = 0; i < kDirections; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / kDirections, angle = 2.399963229728653 * i;
      const double radius = std::sqrt(1.0 - z * z);
      made[static_cast<std::size_t>(i)] = {radius * std::cos(angle), radius * std::sin(angle), z};
    }
    return made;
  }();
  return all;
}

/// The faces of the tooth's blocks as triangles, made where Bullet asks for them.
class ToothShape final : public btConcaveShape {
 public:
  explicit ToothShape(const VoxelGrid& grid)
      : grid_(grid),
        blocks_(grid.cells / kBlockVoxels),
        edge_(kLength * kBlockVoxels * grid.voxel_m) {
    // The type for custom shapes is also that of distance fields, which Bullet then takes it for.
    m_shapeType = FAST_CONCAVE_MESH_PROXYTYPE;
    setMargin(0.0);
  }
  void set_tooth(const VoxelModel* tooth) { tooth_ = tooth; }

  void processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                           const btVector3& high) const override {
    const Eigen::Vector3d first =
        (eigen(low) / edge_ + 0.5 * blocks_.cast<double>()).array().floor();
    const Eigen::Vector3d last =
        (eigen(high) / edge_ + 0.5 * blocks_.cast<double>()).array().floor();
    // Into the grid first: a box may be larger than whole numbers go.
    const Eigen::Vector3d ends = blocks_.cast<double>();
    const Eigen::Vector3i from = first.cwiseMax(0.0).cwiseMin(ends).cast<int>();
    const Eigen::Vector3i to =
        last.cwiseMax(-1.0).cwiseMin((ends.array() - 1.0).matrix()).cast<int>();
    for (int k = from.z(); k <= to.z(); ++k) {
      for (int j = from.y(); j <= to.y(); ++j) {
        for (int i = from.x(); i <= to.x(); ++i) {
          if (solid({i, j, k})) add_faces({i, j, k}, callback);
        }
      }
    }
  }

  void getAabb(const btTransform& place, btVector3& low, btVector3& high) const override {
    btTransformAabb(bullet(0.5 * edge_ * blocks_.cast<double>()), 0.0, place, low, high);
  }
  void setLocalScaling(const btVector3&) override {}
  const btVector3& getLocalScaling() const override { return unscaled_; }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "tooth"; }

 private:
  bool solid(const Eigen::Vector3i& block) const {
    if ((block.array() < 0).any() || (block.array() >= blocks_.array()).any()) return false;
    const Cell first = block * kBlockVoxels;
    const LeafBits& leaf = tooth_->leaves[grid_.leaf_of(first)];
    // A quarter of a slice: four rows of four.
    const std::uint64_t rows = std::uint64_t{0x0f0f0f0f} << (leaf_place(first) & 63);
    int count = 0;
    for (int k = 0; k < kBlockVoxels; ++k) {
      count +=
          std::popcount(leaf.words[static_cast<std::size_t>((leaf_place(first) >> 6) + k)] & rows);
    }
    return 2 * count >= kBlockVoxels * kBlockVoxels * kBlockVoxels;
  }

  void add_faces(const Eigen::Vector3i& block, btTriangleCallback* callback) const {
    const Eigen::Vector3d low = edge_ * (block.cast<double>() - 0.5 * blocks_.cast<double>());
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        Eigen::Vector3i beside = block;
        beside[axis] += 2 * side - 1;
        if (solid(beside)) continue;
        Eigen::Vector3d corner = low, u = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
        corner[axis] += side * edge_;
        u[(axis + 1) % 3] = edge_;
        v[(axis + 2) % 3] = edge_;
        if (side == 0) std::swap(u, v);  // counter-clockwise seen from outside
        btVector3 one[3] = {bullet(corner), bullet(corner + u), bullet(corner + u + v)};
        btVector3 two[3] = {bullet(corner), bullet(corner + u + v), bullet(corner + v)};
        callback->processTriangle(one, 0, 0);
        callback->processTriangle(two, 0, 1);
      }
    }
  }

  VoxelGrid grid_;
  Eigen::Vector3i blocks_;
  double edge_;  // mm
  const VoxelModel* tooth_ = nullptr;
  btVector3 unscaled_{1, 1, 1};
};

}  // namespace

/// Bullet's world with what does not move in it.
struct DebrisWorld::World {
  World(const VoxelGrid& grid, const LoosePiecesSettings& settings,
        std::span<const StillBody> still_bodies)
      : dynamics(&dispatcher, &pairs, &solver, &configuration),
        tooth_shape(grid),
        floor_shape(btVector3(0, 0, 1),
                    kLength * settings.floor_m.value_or(-0.5 * grid.voxel_m * grid.cells.z())) {
    gDeactivationTime = 0.5;  // s, of all of Bullet's worlds; nobody else here has one
    dynamics.setGravity({0, 0, -kLength * kGravity_m_per_s2});
    // Pieces start in their kerfs and may overlap the tooth's blocks: they are moved out of them
    // without being thrown.
    dynamics.getSolverInfo().m_splitImpulsePenetrationThreshold = 0.0;
    tooth.setCollisionShape(&tooth_shape);
    floor.setCollisionShape(&floor_shape);
    add_still(tooth, settings.friction);
    add_still(floor, settings.friction);
    for (const StillBody& body : still_bodies) {
      Other& other = *others.emplace_back(std::make_unique<Other>(body.model->grid));
      other.shape.set_tooth(body.model);
      other.object.setCollisionShape(&other.shape);
      other.object.setWorldTransform(bullet(body.world_from_grid));
      add_still(other.object, settings.friction);
    }
  }
  ~World() {
    for (const auto& other : others) dynamics.removeCollisionObject(&other->object);
    dynamics.removeCollisionObject(&floor);
    dynamics.removeCollisionObject(&tooth);
  }

  void add_still(btCollisionObject& still, double friction) {
    still.setFriction(friction);
    dynamics.addCollisionObject(&still, btBroadphaseProxy::StaticFilter,
                                btBroadphaseProxy::DefaultFilter);
  }

  struct Other {
    explicit Other(const VoxelGrid& grid) : shape(grid) {}
    ToothShape shape;
    btCollisionObject object;
  };

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase pairs;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld dynamics;
  ToothShape tooth_shape;
  btStaticPlaneShape floor_shape;
  btCollisionObject tooth, floor;
  std::vector<std::unique_ptr<Other>> others;
};

struct DebrisWorld::Piece {
  Piece(const VoxelGrid& grid, double friction, std::span<const std::uint32_t> from)
      : voxels(from.begin(), from.end()) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t v : voxels) sum += centre_mm(grid, v);
    start.position = sum / static_cast<double>(voxels.size());

    const double edge = kLength * grid.voxel_m;
    const double voxel_mg = kDensity_kg_per_m3 * grid.voxel_volume_m3() * 1e6;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const std::uint32_t v : voxels) {
      const Eigen::Vector3d r = centre_mm(grid, v) - start.position;
      inertia +=
          (r.squaredNorm() + edge * edge / 6.0) * Eigen::Matrix3d::Identity() - r * r.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(voxel_mg * inertia);
    Eigen::Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
    start.orientation = Eigen::Quaterniond(axes);
    add_hull(grid);
    start.position *= kMillimetre;

    principal_mg_mm2 = principal.eigenvalues();
    mass_mg = voxel_mg * static_cast<double>(voxels.size());
    make_body(friction);
  }

  /// At rest where the piece came loose.
  void make_body(double friction) {
    btRigidBody::btRigidBodyConstructionInfo info(mass_mg, nullptr, &hull,
                                                  bullet(principal_mg_mm2));
    info.m_startWorldTransform = bullet(start);
    info.m_friction = friction;
    body = std::make_unique<btRigidBody>(info);
    body->setSleepingThresholds(kSlow_mm_per_s, kSlow_mm_per_s / half_width_mm);
    // A piece that falls fast is swept, by a ball well inside it.
    body->setCcdMotionThreshold(half_width_mm);
    body->setCcdSweptSphereRadius(0.5 * half_width_mm);
  }

  static Eigen::Vector3d centre_mm(const VoxelGrid& grid, std::uint32_t voxel) {
    return kLength * grid.centre_world(grid.cell_of_linear(voxel));
  }

  /// The outermost voxels in each direction, their corners shrunk by the margin that Bullet adds.
  void add_hull(const VoxelGrid& grid) {
    const double edge = kLength * grid.voxel_m;
    half_width_mm = HUGE_VAL;
    for (const Eigen::Vector3d& direction : directions()) {
      std::uint32_t furthest = voxels.front();
      double most = -HUGE_VAL;
      for (const std::uint32_t v : voxels) {
        const double along = direction.dot(centre_mm(grid, v));
        if (along <= most) continue;
        most = along;
        furthest = v;
      }
      const Eigen::Vector3d corner =
          centre_mm(grid, furthest) + (0.5 - kMargin) * edge * direction.array().sign().matrix();
      hull.addPoint(bullet(start.orientation.conjugate() * (corner - start.position)), false);
      half_width_mm = std::min(half_width_mm, most - direction.dot(start.position) + 0.5 * edge);
    }
    hull.recalcLocalAabb();
    hull.setMargin(kMargin * edge);
  }

  std::vector<std::uint32_t> voxels;
  Pose start;  // of the body's axes, world
  double half_width_mm = 0.0, mass_mg = 0.0;
  Eigen::Vector3d principal_mg_mm2 = Eigen::Vector3d::Zero();  // moments of inertia
  btConvexHullShape hull;
  std::unique_ptr<btRigidBody> body;
};

DebrisWorld::DebrisWorld(const VoxelGrid& grid, const LoosePiecesSettings& settings,
                         std::vector<StillBody> others)
    : grid_(grid),
      settings_(settings),
      others_(std::move(others)),
      world_(std::make_unique<World>(grid, settings, others_)) {}

DebrisWorld::DebrisWorld(DebrisWorld&&) noexcept = default;

DebrisWorld::~DebrisWorld() {
  for (const auto& piece : pieces_) world_->dynamics.removeRigidBody(piece->body.get());
}

std::size_t DebrisWorld::add(std::span<const std::uint32_t> voxels) {
  pieces_.push_back(std::make_unique<Piece>(grid_, settings_.friction, voxels));
  world_->dynamics.addRigidBody(pieces_.back()->body.get());
  return pieces_.size() - 1;
}

void DebrisWorld::step(double dt_s, const VoxelModel& tooth) {
  ++steps_;
  if (pieces_.empty()) return;
  if (steps_ % kRebuildEvery == 0) rebuild();
  const auto moves = [](const auto& piece) { return piece->body->isActive(); };
  if (std::ranges::none_of(pieces_, moves)) return;
  world_->tooth_shape.set_tooth(&tooth);
  const double steps = std::ceil(dt_s / kLongestStep_s - 1e-9);
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    world_->dynamics.stepSimulation(dt_s / steps, 0);
  }
}

void DebrisWorld::wake(const Eigen::AlignedBox3d& cut_world, double voxel_m) {
  const double reach_mm = std::max(0.5, kLength * kBlockVoxels * voxel_m);
  const btVector3 reach(reach_mm, reach_mm, reach_mm);
  const btVector3 first = bullet(kLength * cut_world.min()) - reach;
  const btVector3 last = bullet(kLength * cut_world.max()) + reach;
  for (const auto& piece : pieces_) {
    if (piece->body->isActive()) continue;
    btVector3 low, high;
    piece->body->getAabb(low, high);
    if (TestAabbAgainstAabb2(low, high, first, last)) piece->body->activate(true);
  }
}

Pose DebrisWorld::pose(std::size_t piece) const {
  const Pose now = pose_of(pieces_[piece]->body->getWorldTransform());
  const Pose& start = pieces_[piece]->start;
  const Eigen::Quaterniond turn = now.orientation * start.orientation.conjugate();
  return {now.position - turn * start.position, turn};
}

bool DebrisWorld::at_rest(std::size_t piece) const { return !pieces_[piece]->body->isActive(); }

DebrisWorld::State DebrisWorld::save() const {
  State state;
  state.steps = steps_;
  for (const auto& piece : pieces_) {
    const btRigidBody& body = *piece->body;
    const btTransform& at = body.getWorldTransform();
    const btMatrix3x3& axes = at.getBasis();
    PieceState& saved = state.pieces.emplace_back();
    saved.voxels = piece->voxels;
    for (int a = 0; a < 3; ++a) {
      saved.position_mm[a] = at.getOrigin()[a];
      saved.velocity_mm_per_s[a] = body.getLinearVelocity()[a];
      saved.turning_rad_per_s[a] = body.getAngularVelocity()[a];
      for (int b = 0; b < 3; ++b) saved.axes(a, b) = axes[a][b];
    }
    saved.slow_s = body.getDeactivationTime();
    saved.activation = body.getActivationState();
  }
  return state;
}

void DebrisWorld::restore(const State& state) {
  clear();
  pieces_.clear();
  for (const PieceState& saved : state.pieces) {
    pieces_.push_back(std::make_unique<Piece>(grid_, settings_.friction, saved.voxels));
  }
  populate(state);
}

void DebrisWorld::rebuild() {
  // As `restore` does, but for the hulls, which are the same.
  const State state = save();
  clear();
  for (const auto& piece : pieces_) piece->make_body(settings_.friction);
  populate(state);
}

/// Takes the pieces out of the world, which is no more afterwards.
void DebrisWorld::clear() {
  for (const auto& piece : pieces_) world_->dynamics.removeRigidBody(piece->body.get());
  world_ = std::make_unique<World>(grid_, settings_, others_);
}

/// Puts the pieces into an empty world as they were.
void DebrisWorld::populate(const State& state) {
  steps_ = state.steps;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const PieceState& saved = state.pieces[i];
    btRigidBody& body = *pieces_[i]->body;
    btTransform at;
    at.setOrigin(bullet(saved.position_mm));
    const Eigen::Matrix3d& m = saved.axes;
    at.setBasis({m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)});
    body.setCenterOfMassTransform(at);
    body.setLinearVelocity(bullet(saved.velocity_mm_per_s));
    body.setAngularVelocity(bullet(saved.turning_rad_per_s));
    world_->dynamics.addRigidBody(&body);
    body.forceActivationState(saved.activation);
    body.setDeactivationTime(saved.slow_s);
  }
}

std::size_t DebrisWorld::memory_bytes() const {
  std::size_t bytes = sizeof(World);
  for (const auto& piece : pieces_) {
    bytes += sizeof(Piece) + sizeof(btRigidBody) +
             piece->voxels.capacity() * sizeof(std::uint32_t) +
             static_cast<std::size_t>(piece->hull.getNumPoints()) * sizeof(btVector3);
  }
  return bytes;
}

}  // namespace sulcus
