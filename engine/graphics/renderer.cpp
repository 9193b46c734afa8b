#include "engine/graphics/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <epoxy/gl.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/graphics/burr_shading.hpp"
#include "engine/graphics/camera.hpp"
#include "engine/graphics/piece_mesh.hpp"
#include "engine/graphics/shaders.hpp"

namespace sulcus {
namespace {

constexpr std::size_t kBatch = 64;  // bricks meshed before they are handed over

void* buffer_offset(std::size_t bytes) { return reinterpret_cast<void*>(bytes); }

void make_buffers(unsigned& array, unsigned& vertices, unsigned& indices) {
  glGenVertexArrays(1, &array);
  glGenBuffers(1, &vertices);
  glGenBuffers(1, &indices);
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, vertices);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
}

}  // namespace

Renderer::Renderer(const RenderSettings& settings, VoxelModel model, std::vector<TissueLook> looks,
                   const TriangleMesh& burr_mesh_tool, double burr_head_length_m)
    : settings_(settings),
      camera_(settings.camera),
      surface_(std::move(model), std::move(looks)),
      occlusion_(surface_.model(), surface_.density()),
      solid_world_(solid_slabs(surface_.model())),
      burr_head_length_m_(burr_head_length_m),
      background_program_("background", kBackgroundVertex, kBackgroundFragment),
      tooth_program_("tooth", kToothVertex, kToothFragment),
      burr_program_("burr", kBurrVertex, kBurrFragment),
      smooth_program_("smooth", kBackgroundVertex, kSmoothFragment),
      bricks_(surface_.brick_count()) {
  set_size(settings.width, settings.height);
  glGenVertexArrays(1, &background_array_);
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
  upload_burr(burr_mesh_tool);
}

Renderer::~Renderer() {
  context_.make_current();
  auto drop = [](Brick& brick) {
    glDeleteVertexArrays(1, &brick.array);
    glDeleteBuffers(1, &brick.vertices);
    glDeleteBuffers(1, &brick.indices);
  };
  for (Brick& brick : bricks_) drop(brick);
  for (Brick& piece : pieces_) drop(piece);
  drop(burr_);
  glDeleteVertexArrays(1, &background_array_);
  glDeleteTextures(1, &occlusion_texture_);
}

void Renderer::set_size(int width, int height) {
  context_.make_current();
  if (frame_ && frame_->width() == width && frame_->height() == height) return;
  frame_ = std::make_unique<GlFramebuffer>(width, height);
  if (settings_.hud) hud_.emplace(height);
}

void Renderer::add_piece(std::span<const std::uint32_t> voxels) {
  const DrawnMesh mesh = piece_mesh(surface_, voxels);
  occlusion_.add_piece(surface_.model().grid, voxels);
  context_.make_current();
  upload(pieces_.emplace_back(), mesh);
}

void Renderer::upload(Brick& brick, const DrawnMesh& mesh) {
  brick.index_count = static_cast<int>(mesh.indices.size());
  brick.bytes = mesh.vertices.size() * sizeof(DrawnVertex) + mesh.indices.size() * 4;
  if (mesh.indices.empty()) return;  // its buffers, if any, wait for the next time
  if (brick.array == 0) {
    make_buffers(brick.array, brick.vertices, brick.indices);
    constexpr GLsizei stride = sizeof(DrawnVertex);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
    glVertexAttribPointer(1, 4, GL_SHORT, GL_TRUE, stride,
                          buffer_offset(offsetof(DrawnVertex, normal)));
    glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                          buffer_offset(offsetof(DrawnVertex, colour_cut)));
    for (const GLuint attribute : {0u, 1u, 2u}) glEnableVertexAttribArray(attribute);
  }
  glBindVertexArray(brick.array);
  glBindBuffer(GL_ARRAY_BUFFER, brick.vertices);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(DrawnVertex)),
               mesh.vertices.data(), GL_STATIC_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * 4),
               mesh.indices.data(), GL_STATIC_DRAW);
  Eigen::AlignedBox3f box;
  for (const DrawnVertex& v : mesh.vertices) {
    box.extend(Eigen::Vector3f(v.position_m[0], v.position_m[1], v.position_m[2]));
  }
  brick.centre_world = box.center();
}

void Renderer::upload_burr(const TriangleMesh& mesh_tool) {
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    if (p.y() > burr_head_length_m_) continue;
    burr_radius_m_ = std::max(burr_radius_m_, static_cast<double>(std::hypot(p.x(), p.z())));
  }
  const std::vector<BurrCorner> corners = shaded_corners(mesh_tool);
  burr_.index_count = static_cast<int>(corners.size());
  burr_.bytes = corners.size() * sizeof(BurrCorner);
  if (corners.empty()) return;
  make_buffers(burr_.array, burr_.vertices, burr_.indices);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(burr_.bytes), corners.data(),
               GL_STATIC_DRAW);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(BurrCorner), nullptr);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(BurrCorner),
                        buffer_offset(offsetof(BurrCorner, normal_tool)));
  for (const GLuint attribute : {0u, 1u}) glEnableVertexAttribArray(attribute);
}

void Renderer::upload_occlusion(const Occlusion::Box& box) {
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

void Renderer::mesh_changes() {
  upload_occlusion(
      occlusion_.update(surface_.model(), surface_.density(), surface_.take_changed_leaves()));
  const std::vector<int> changed = surface_.take_changed();
  tbb::enumerable_thread_specific<DrawnSurface::Scratch> scratch;
  std::vector<DrawnMesh> meshes(std::min(changed.size(), kBatch));
  for (std::size_t first = 0; first < changed.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, changed.size() - first);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      surface_.mesh(changed[first + i], scratch.local(), meshes[i]);
    });
    for (std::size_t i = 0; i < count; ++i) upload(bricks_[changed[first + i]], meshes[i]);
  }
}

void Renderer::use_tooth_program(const View& view, const Pose& world_now_from_start) {
  const View seen = view_of_moved(view, world_now_from_start);
  tooth_program_.use();
  tooth_program_.set("clip_from_world", seen.clip_from_world);
  tooth_program_.set("eye_world", seen.eye_world);
  tooth_program_.set("right_world", seen.right_world);
  tooth_program_.set("up_world", seen.up_world);
  tooth_program_.set("back_world", seen.back_world);
  const VoxelGrid& grid = surface_.model().grid;
  const Eigen::Vector3d texture_m = occlusion_.dims().cast<double>() * occlusion_.cell_m();
  const Eigen::Vector3d half_m = 0.5 * grid.voxel_m * grid.cells.cast<double>();
  // A piece is shaded by what is solid where it is now.
  Eigen::Matrix4d texture_from_now = Eigen::Matrix4d::Identity();
  texture_from_now.diagonal().head<3>() = texture_m.cwiseInverse();
  texture_from_now.topRightCorner<3, 1>() = half_m.cwiseQuotient(texture_m);
  tooth_program_.set(
      "texture_from_world",
      Eigen::Matrix4f((texture_from_now * matrix_of(world_now_from_start)).cast<float>()));
  tooth_program_.set("occlusion_cell", static_cast<float>(occlusion_.cell_m()));
  tooth_program_.set("occlusion", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, occlusion_texture_);
}

void Renderer::draw_tooth(const View& view) {
  use_tooth_program(view, {});
  // Nearest first: what they hide is then never shaded.
  std::vector<std::pair<float, const Brick*>> order;
  for (const Brick& brick : bricks_) {
    if (brick.index_count == 0) continue;
    order.emplace_back((brick.centre_world - view.eye_world).squaredNorm(), &brick);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [distance, brick] : order) {
    glBindVertexArray(brick->array);
    glDrawElements(GL_TRIANGLES, brick->index_count, GL_UNSIGNED_INT, nullptr);
  }
}

void Renderer::draw_pieces(const View& view, std::span<const Pose> world_now_from_start) {
  for (std::size_t i = 0; i < std::min(pieces_.size(), world_now_from_start.size()); ++i) {
    if (pieces_[i].index_count == 0) continue;
    use_tooth_program(view, world_now_from_start[i]);
    glBindVertexArray(pieces_[i].array);
    glDrawElements(GL_TRIANGLES, pieces_[i].index_count, GL_UNSIGNED_INT, nullptr);
  }
}

void Renderer::draw_burr(const View& view, const FrameState& state) {
  if (burr_.index_count == 0) return;
  const Eigen::Matrix4f world_from_tool = matrix_of(state.world_from_tool).cast<float>();
  burr_program_.use();
  burr_program_.set("clip_from_world", view.clip_from_world);
  burr_program_.set("world_from_tool", world_from_tool);
  burr_program_.set("eye_world", view.eye_world);
  burr_program_.set("right_world", view.right_world);
  burr_program_.set("up_world", view.up_world);
  burr_program_.set("back_world", view.back_world);
  burr_program_.set("head_length", static_cast<float>(std::max(burr_head_length_m_, 1e-6)));
  burr_program_.set("head_radius", static_cast<float>(std::max(burr_radius_m_, 1e-6)));
  // Whole turns are taken off before the precision of a float would show.
  burr_program_.set("turn",
                    static_cast<float>(std::remainder(state.burr_turn_rad, 2 * std::numbers::pi)));
  glBindVertexArray(burr_.array);
  glDrawArrays(GL_TRIANGLES, 0, burr_.index_count);
}

Image Renderer::draw(const FrameState& state) {
  context_.make_current();
  mesh_changes();
  for (const Occlusion::Box& box : occlusion_.place_pieces(state.pieces)) upload_occlusion(box);
  const View view = make_view(camera_, solid_world_, state.world_from_tool.position, burr_radius_m_,
                              frame_->width(), frame_->height());
  frame_->begin();
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  background_program_.use();
  glBindVertexArray(background_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  draw_burr(view, state);
  draw_tooth(view);
  draw_pieces(view, state.pieces);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  frame_->begin_overlay();
  smooth_program_.use();
  smooth_program_.set("picture", 0);
  glBindVertexArray(background_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  if (hud_) hud_->draw(state, frame_->width(), frame_->height(), view.metres_per_pixel);
  return frame_->read();
}

std::size_t Renderer::triangle_count() const {
  std::size_t count = 0;
  for (const Brick& brick : bricks_) count += static_cast<std::size_t>(brick.index_count) / 3;
  for (const Brick& piece : pieces_) count += static_cast<std::size_t>(piece.index_count) / 3;
  return count;
}

std::size_t Renderer::memory_bytes() const {
  std::size_t bytes = surface_.memory_bytes() + burr_.bytes + bricks_.capacity() * sizeof(Brick) +
                      occlusion_.memory_bytes() + 2 * occlusion_.values().size();  // the texture
  for (const Brick& brick : bricks_) bytes += brick.bytes;
  for (const Brick& piece : pieces_) bytes += sizeof(Brick) + piece.bytes;
  const std::size_t pixels = static_cast<std::size_t>(frame_->width()) * frame_->height();
  return bytes + pixels * 12;
}

}  // namespace sulcus
