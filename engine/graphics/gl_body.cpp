#include "engine/graphics/gl_body.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <Eigen/Core>
#include <epoxy/gl.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/graphics/geometry_image.hpp"
#include "engine/surface/piece_mesh.hpp"

namespace sulcus {
namespace {

constexpr std::size_t kBatch = 64;  // bricks meshed before they are handed over
// Cells of occlusion from a vertex to the farthest that its light is read from (kToothVertex), and
// those round that, with a triangle's width.
constexpr double kShadedFrom = 10.0;
// In a hurry: updates from one in which light some way off is seen to to the next, and bricks whose
// normals are found anew then.
constexpr int kLightAfter = 4;
constexpr std::size_t kLitAtOnce = 4;

bool meet(const PixelRect& a, const PixelRect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

}  // namespace

/// What meshing works with, kept from picture to picture.
struct GlBody::Workshop {
  tbb::enumerable_thread_specific<DrawnSurface::Scratch> scratch;
  std::vector<DrawnMesh> meshes;
};

GlBody::GlBody(RenderedBody body)
    : surface_(std::move(body.model), std::move(body.looks)),
      world_from_grid_(body.world_from_grid),
      solid_at_start_(solid_slabs(surface_.model())),
      occlusion_(surface_.model(), surface_.density()),
      workshop_(std::make_unique<Workshop>()) {
  glGenTextures(1, &occlusion_texture_);
  glBindTexture(GL_TEXTURE_3D, occlusion_texture_);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_BORDER);  // nothing is solid out there
  }
  const Eigen::Vector3i& dims = occlusion_.dims();
  glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R16, dims.x(), dims.y(), dims.z(), 0, GL_RED, GL_UNSIGNED_SHORT,
               occlusion_.values().data());
}

GlBody::~GlBody() { glDeleteTextures(1, &occlusion_texture_); }

void GlBody::add_piece(std::span<const std::uint32_t> voxels) {
  const DrawnMesh mesh = piece_mesh(surface_, voxels);
  occlusion_.add_piece(surface_.model().grid, voxels);
  pieces_.emplace_back().upload(mesh);
}

void GlBody::upload_occlusion(const Occlusion::Box& box) {
  const Eigen::Vector3i size = box.high - box.low;
  if ((size.array() <= 0).any()) return;
  const Eigen::Vector3i& dims = occlusion_.dims();
  glBindTexture(GL_TEXTURE_3D, occlusion_texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, dims.x());
  glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, dims.y());
  const std::size_t first =
      static_cast<std::size_t>(box.low.x()) +
      static_cast<std::size_t>(dims.x()) *
          (static_cast<std::size_t>(box.low.y()) +
           static_cast<std::size_t>(dims.y()) * static_cast<std::size_t>(box.low.z()));
  glTexSubImage3D(GL_TEXTURE_3D, 0, box.low.x(), box.low.y(), box.low.z(), size.x(), size.y(),
                  size.z(), GL_RED, GL_UNSIGNED_SHORT, occlusion_.values().data() + first);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 0);
}

Eigen::AlignedBox3f GlBody::shaded_by(const Occlusion::Box& box) const {
  if (((box.high - box.low).array() <= 0).any()) return {};
  const VoxelGrid& grid = surface_.model().grid;
  const Eigen::Vector3d half_m = 0.5 * grid.voxel_m * grid.cells.cast<double>();
  const auto at = [&](const Eigen::Vector3i& cell, double beyond) -> Eigen::Vector3f {
    return ((cell.cast<double>().array() + beyond) * occlusion_.cell_m() - half_m.array())
        .cast<float>();
  };
  return {at(box.low, -kShadedFrom), at(box.high, kShadedFrom)};
}

Eigen::AlignedBox3f GlBody::update(std::span<const Pose> pieces, bool hurried, Detail detail) {
  detail_ = detail;
  std::vector<GlMesh>& bricks = bricks_[static_cast<std::size_t>(detail)];
  if (bricks.empty()) bricks = std::vector<GlMesh>(surface_.brick_count(detail));
  std::vector<int> changed = surface_.take_changed(0, detail);
  Eigen::AlignedBox3f touched;
  if (!hurried || changed.empty() || ++updates_without_light_ == kLightAfter) {
    updates_without_light_ = 0;
    const Occlusion::Box occluded =
        occlusion_.update(surface_.model(), surface_.density(), surface_.take_changed_leaves());
    upload_occlusion(occluded);
    touched = shaded_by(occluded);
    const std::vector<int> lit = surface_.take_changed(
        hurried ? kLitAtOnce : std::numeric_limits<std::size_t>::max(), detail);
    changed.insert(changed.end(), lit.begin(), lit.end());
  }
  std::vector<DrawnMesh>& meshes = workshop_->meshes;
  meshes.resize(std::max(meshes.size(), std::min(changed.size(), kBatch)));
  for (std::size_t first = 0; first < changed.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, changed.size() - first);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      surface_.mesh(changed[first + i], workshop_->scratch.local(), meshes[i], detail);
    });
    for (std::size_t i = 0; i < count; ++i) {
      GlMesh& brick = bricks[changed[first + i]];
      touched.extend(brick.box());
      brick.upload(meshes[i]);
      touched.extend(brick.box());
    }
  }
  for (const Occlusion::Box& box : occlusion_.place_pieces(surface_.density(), pieces)) {
    upload_occlusion(box);
  }
  return moved_box(touched, world_from_grid_);
}

void GlBody::use(GlProgram& program, const View& view, const Pose& world_now_from_start) const {
  const View seen = view_of_moved(view, world_now_from_start);
  program.use();
  program.set("clip_from_world", seen.clip_from_world);
  program.set("eye_world", seen.eye_world);
  program.set("right_world", seen.right_world);
  program.set("up_world", seen.up_world);
  program.set("back_world", seen.back_world);
  program.set("shown", seen.shown_world);
  const VoxelGrid& grid = surface_.model().grid;
  const Eigen::Vector3d texture_m = occlusion_.dims().cast<double>() * occlusion_.cell_m();
  const Eigen::Vector3d half_m = 0.5 * grid.voxel_m * grid.cells.cast<double>();
  // A piece is shaded by what is solid where it is now.
  Eigen::Matrix4d texture_from_now = Eigen::Matrix4d::Identity();
  texture_from_now.diagonal().head<3>() = texture_m.cwiseInverse();
  texture_from_now.topRightCorner<3, 1>() = half_m.cwiseQuotient(texture_m);
  program.set("texture_from_world",
              Eigen::Matrix4f((texture_from_now * matrix_of(world_now_from_start)).cast<float>()));
  program.set("occlusion_cell", static_cast<float>(occlusion_.cell_m()));
  program.set("occlusion", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, occlusion_texture_);
}

void GlBody::draw(GlProgram& program, const View& view_world, std::span<const Pose> pieces,
                  const PixelRect& pixels, int width, int height) const {
  const View view = view_of_moved(view_world, world_from_grid_);
  use(program, view, {});
  // Nearest first: what they hide is then never shaded.
  std::vector<std::pair<float, const GlMesh*>> order;
  for (const GlMesh& brick : bricks()) {
    if (brick.empty() || !may_be_in_frame(view, brick.box())) continue;
    if (faces_away(brick.cone(), brick.box(), view.eye_world)) continue;
    if (!meet(pixels_of(view, brick.box(), width, height), pixels)) continue;
    order.emplace_back((brick.box().center() - view.eye_world).squaredNorm(), &brick);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [distance, brick] : order) brick->draw();
  for (std::size_t i = 0; i < std::min(pieces_.size(), pieces.size()); ++i) {
    if (pieces_[i].empty()) continue;
    use(program, view, pieces[i]);
    program.set("shown", Eigen::Vector4f(Eigen::Vector4f::UnitW()));  // a section has no face of it
    program.set("object", ShownObject::piece(i).code());              // of who wants to know
    pieces_[i].draw();
  }
}

Eigen::AlignedBox3d GlBody::box_world() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::AlignedBox3d& slab : solid_at_start_) {
    for (int corner = 0; corner < 8; ++corner) {
      box.extend(world_from_grid_.point(
          slab.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
    }
  }
  return box;
}

std::size_t GlBody::triangle_count() const {
  std::size_t count = 0;
  for (const GlMesh& brick : bricks()) count += brick.triangle_count();
  for (const GlMesh& piece : pieces_) count += piece.triangle_count();
  return count;
}

std::size_t GlBody::memory_bytes() const {
  std::size_t bytes = surface_.memory_bytes() + occlusion_.memory_bytes() +
                      2 * occlusion_.values().size();  // the texture
  for (const std::vector<GlMesh>& bricks : bricks_) {
    for (const GlMesh& brick : bricks) bytes += sizeof(GlMesh) + brick.bytes();
  }
  for (const GlMesh& piece : pieces_) bytes += sizeof(GlMesh) + piece.bytes();
  return bytes;
}

}  // namespace sulcus
