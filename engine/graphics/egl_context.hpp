#pragma once

#include <span>
#include <string>

namespace sulcus {

enum class EglPlatform { kSurfaceless, kDevice, kDefault };

/// Where a context is looked for, in this order: Mesa without any window system, a graphics card
/// named through EGL's device list, whatever the system's default display is.
inline constexpr EglPlatform kEglPlatforms[] = {EglPlatform::kSurfaceless, EglPlatform::kDevice,
                                                EglPlatform::kDefault};

/// An OpenGL core context, 4.5 or else 3.3, that needs no display and has no surface: one draws
/// into framebuffer objects. Current on the thread that made it, and to be destroyed there.
class EglContext {
 public:
  /// Throws std::runtime_error that names everything tried.
  explicit EglContext(std::span<const EglPlatform> platforms = kEglPlatforms);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes it current on the calling thread again, where another context has been since.
  void make_current() const;
  /// Such as "surfaceless Mesa, llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
  const std::string& description() const { return description_; }

 private:
  bool open(void* display, const std::string& name, std::string& tried);

  void* display_ = nullptr;  // EGLDisplay, EGLContext, EGLSurface: their headers stay out of here
  void* context_ = nullptr;
  void* surface_ = nullptr;  // one pixel, where contexts without a surface are not supported
  std::string description_;
};

}  // namespace sulcus
