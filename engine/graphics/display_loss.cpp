#include "engine/graphics/display_loss.hpp"

#include <dlfcn.h>
#include <poll.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace sulcus {

namespace {

bool lost = false;  // the main thread's

// Of Xlib.h, which a machine without X has not. GLFW loads the library itself, where there is one.
struct XError {
  int type;
  void* display;
  unsigned long resource;
  unsigned long serial;
  unsigned char error_code, request_code, minor_code;
};
constexpr unsigned char kBadWindow = 3, kBadDrawable = 9;
using ErrorHandler = int (*)(void* display, XError* error);
using IoErrorHandler = int (*)(void* display);
using IoErrorExitHandler = void (*)(void* display, void* user_data);

unsigned long window_id = 0;
int connection = -1;  // to the display

int on_error(void*, XError* error) {
  const bool is_gone = error->error_code == kBadWindow || error->error_code == kBadDrawable;
  if (is_gone && error->resource == window_id) lost = true;
  return 0;
}
int on_io_error(void*) {
  lost = true;
  return 0;
}
void on_io_exit(void*, void*) { lost = true; }

template <class Function>
Function* find(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

}  // namespace

void watch_for_display_loss() {
  auto* const display_of = find<void*()>(RTLD_DEFAULT, "glfwGetX11Display");
  auto* const window_of = find<unsigned long(GLFWwindow*)>(RTLD_DEFAULT, "glfwGetX11Window");
  void* const xlib = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
  if (!display_of || !window_of || !xlib) return;
  void* const display = display_of();
  GLFWwindow* const window = glfwGetCurrentContext();
  if (display && window) {
    window_id = window_of(window);
    if (auto* number = find<int(void*)>(xlib, "XConnectionNumber")) connection = number(display);
    if (auto* set = find<void*(ErrorHandler)>(xlib, "XSetErrorHandler")) set(on_error);
    // Of libX11 1.7 on: before, Xlib ends the process whatever is said here.
    if (auto* set = find<void(void*, IoErrorExitHandler, void*)>(xlib, "XSetIOErrorExitHandler")) {
      set(display, on_io_exit, nullptr);
      if (auto* quiet = find<void*(IoErrorHandler)>(xlib, "XSetIOErrorHandler")) quiet(on_io_error);
    }
  }
  dlclose(xlib);
}

/// Also asks the connection: Mesa, told to show a picture on one that is broken, may take a minute.
bool display_is_lost() {
  pollfd state{.fd = connection, .events = 0, .revents = 0};
  if (!lost && connection >= 0 && poll(&state, 1, 0) > 0) {
    lost = (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
  }
  return lost;
}

}  // namespace sulcus
