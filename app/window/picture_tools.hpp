#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "app/window/caliper.hpp"
#include "app/window/camera_hand.hpp"
#include "app/window/pointer_pick.hpp"
#include "app/window/pulp_nearness.hpp"
#include "engine/graphics/gl_framebuffer.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/overlay.hpp"
#include "engine/graphics/panels.hpp"
#include "engine/graphics/window.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What both windows do with the picture: camera, place under the pointer, caliper, and what is
/// shown over it. Main thread.
class PictureTools {
 public:
  /// The button that turns the tooth; with shift it moves the picture.
  enum class Turns : std::uint8_t { kLeft, kRight };

  /// `start`: the tooth before anything is cut. All but `start` outlive it.
  PictureTools(const Scene& scene, const VoxelModel& start, const Burr& burr, Turns turns);

  /// What mouse and keys ask of the picture that is seen; also closes the window.
  void follow(const WindowInput& input, const GlScene& drawing, CameraHand& camera, Window& window,
              PictureControls& controls, bool in_recording);
  /// Whether the camera is moved, so that less has to be drawn.
  bool is_moving() const { return moving_; }
  /// Ends the window's frame: the picture that has been drawn, and what is shown over it.
  void end_frame(GlScene& drawing, const FrameState& state, const CameraHand& camera,
                 Window& window, const PictureControls& controls, bool in_recording);

 private:
  void take_key(char key, CameraHand& camera, Window& window, PictureControls& controls,
                bool in_recording);
  void add_caliper(const View& view, Overlay& overlay) const;
  void add_status(const FrameState& state, Overlay& overlay) const;
  void draw_over(const GlScene& drawing, const FrameState& state, const Window& window,
                 const PictureControls& controls, bool in_recording);

  const Scene& scene_;
  const Burr& burr_;
  Turns turns_;
  PulpNearness pulp_;
  bool moving_ = false;
  std::optional<PickedPoint> under_pointer_;
  std::string tissue_;  // there
  std::optional<Eigen::Vector3d> grabbed_world_;
  Caliper caliper_;
  std::string copied_;
  int frames_to_mirror_ = 0;               // until it is drawn again
  const GlFramebuffer* mirror_ = nullptr;  // as it was drawn last
  Eigen::Vector2i mirror_at_{0, 0};
};

}  // namespace sulcus
