#include "engine/graphics/egl_context.hpp"

#include <cstdio>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

namespace sulcus {
namespace {

bool lists(const char* extensions, std::string_view name) {
  std::string_view rest = extensions == nullptr ? "" : extensions;
  while (!rest.empty()) {
    const std::size_t end = rest.find(' ');
    if (rest.substr(0, end) == name) return true;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  return false;
}

/// Extension functions are asked for by name: epoxy ends the process where one is missing.
template <class Function>
Function extension(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::string last_error() {
  char text[16];
  std::snprintf(text, sizeof text, "0x%04x", static_cast<unsigned>(eglGetError()));
  return text;
}

struct Candidate {
  std::string name;
  EGLDisplay display;
};

/// Displays of a platform; what is missing goes into `tried`.
std::vector<Candidate> displays(EglPlatform platform, std::string& tried) {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto get_display = extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  std::vector<Candidate> found;
  switch (platform) {
    case EglPlatform::kSurfaceless:
      if (get_display == nullptr || !lists(client, "EGL_MESA_platform_surfaceless")) {
        tried += "; surfaceless Mesa: not supported here";
        break;
      }
      found.push_back({"surfaceless Mesa",
                       get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)});
      break;
    case EglPlatform::kDevice: {
      const auto query = extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
      EGLDeviceEXT devices[16];
      EGLint count = 0;
      if (get_display == nullptr || query == nullptr || !lists(client, "EGL_EXT_platform_device") ||
          query(16, devices, &count) != EGL_TRUE || count == 0) {
        tried += "; EGL devices: none listed";
        break;
      }
      for (int i = 0; i < count; ++i) {
        found.push_back({"EGL device " + std::to_string(i),
                         get_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr)});
      }
      break;
    }
    case EglPlatform::kDefault:
      found.push_back({"default display", eglGetDisplay(EGL_DEFAULT_DISPLAY)});
      break;
  }
  return found;
}

}  // namespace

EglContext::EglContext(std::span<const EglPlatform> platforms) {
  void* const library = dlopen("libEGL.so.1", RTLD_LAZY);
  if (library == nullptr) {
    throw std::runtime_error("no picture can be drawn: libEGL.so.1 is not installed");
  }
  dlclose(library);
  std::string tried;
  for (const EglPlatform platform : platforms) {
    for (const Candidate& candidate : displays(platform, tried)) {
      if (open(candidate.display, candidate.name, tried)) return;
    }
  }
  throw std::runtime_error("no picture can be drawn: no OpenGL context by EGL" + tried);
}

bool EglContext::open(void* display, const std::string& name, std::string& tried) {
  auto fail = [&](const std::string& what) {
    tried += "; " + name + ": " + what + " (" + last_error() + ")";
    return false;
  };
  EGLint major = 0;
  EGLint minor = 0;
  if (display == EGL_NO_DISPLAY) return fail("no display");
  if (eglInitialize(display, &major, &minor) != EGL_TRUE) return fail("not initialised");
  const bool needs_surface =
      !lists(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context");
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return fail("no OpenGL");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, needs_surface ? EGL_PBUFFER_BIT : 0,
                           EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglChooseConfig(display, wanted, &config, 1, &configs) != EGL_TRUE || configs == 0) {
    return fail("no configuration for OpenGL");
  }
  EGLContext context = EGL_NO_CONTEXT;
  for (const auto& [gl_major, gl_minor] : {std::pair{4, 5}, std::pair{3, 3}}) {
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 gl_major,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 gl_minor,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (context != EGL_NO_CONTEXT) break;
  }
  if (context == EGL_NO_CONTEXT) return fail("no OpenGL 4.5 or 3.3 core context");
  EGLSurface surface = EGL_NO_SURFACE;
  if (needs_surface) {
    const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    surface = eglCreatePbufferSurface(display, config, size);
  }
  if (eglMakeCurrent(display, surface, surface, context) != EGL_TRUE) {
    const bool result = fail("the context could not be made current");
    eglDestroyContext(display, context);
    return result;
  }
  display_ = display;
  context_ = context;
  surface_ = surface;
  description_ = name + ", " + reinterpret_cast<const char*>(glGetString(GL_RENDERER)) +
                 ", OpenGL " + std::to_string(epoxy_gl_version() / 10) + "." +
                 std::to_string(epoxy_gl_version() % 10);
  return true;
}

EglContext::~EglContext() {
  // The display stays: other contexts of the process share it.
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
  eglDestroyContext(display_, context_);
}

void EglContext::make_current() const {
  if (eglGetCurrentContext() == context_) return;
  if (eglMakeCurrent(display_, surface_, surface_, context_) != EGL_TRUE) {
    throw std::runtime_error("the OpenGL context could not be made current (" + last_error() +
                             "); it belongs to the thread that made it");
  }
}

}  // namespace sulcus
