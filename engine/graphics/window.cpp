#include "engine/graphics/window.hpp"

#include <cctype>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "engine/graphics/display_loss.hpp"

namespace sulcus {

namespace {

constexpr double kShortestFrame_s = 1.0 / 60.0;

std::string glfw_reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

/// A window's size, but at least 16 pixels each way and at most what OpenGL draws.
Eigen::Vector2i drawn_size(const Eigen::Vector2i& size) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  return size.cwiseMin(largest).cwiseMax(16);
}

GLFWwindow* open_window(const std::string& title, int width, int height) {
  // EGL as off the screen, else what the window system has of its own.
  for (const int api : {GLFW_EGL_CONTEXT_API, GLFW_NATIVE_CONTEXT_API}) {
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    if (GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr)) {
      return window;
    }
  }
  return nullptr;
}

}  // namespace

Window::Window(const std::string& title, int width, int height) {
  if (!glfwInit())
    throw std::runtime_error("no display for a window (" + glfw_reason() +
                             "); sulcus render draws without one");
  window_ = open_window(title, width, height);
  if (!window_) {
    const std::string why = glfw_reason();
    glfwTerminate();
    throw std::runtime_error("no window with OpenGL 3.3 (" + why + ")");
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, &keys_);
  // Before ImGui's, which calls it.
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    const bool arrow = key == GLFW_KEY_LEFT || key == GLFW_KEY_RIGHT;
    if (action == GLFW_RELEASE || (action == GLFW_REPEAT && !arrow)) return;
    std::string& keys = *static_cast<std::string*>(glfwGetWindowUserPointer(window));
    if (key == GLFW_KEY_ESCAPE) keys += WindowInput::kEscape;
    if (key == GLFW_KEY_LEFT) keys += '<';
    if (key == GLFW_KEY_RIGHT) keys += '>';
    if (key == GLFW_KEY_SPACE || (key >= GLFW_KEY_0 && key <= GLFW_KEY_Z)) {
      keys += static_cast<char>(std::tolower(key));
    }
  });
  IMGUI_CHECKVERSION();
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  const char* const font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  if (std::filesystem::exists(font)) io.Fonts->AddFontFromFileTTF(font, 15.0f);
  ImGui::StyleColorsLight();
  ImGui::GetStyle().WindowRounding = 6.0f;
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
  watch_for_display_loss();
  glfwGetFramebufferSize(window_, &size_.x(), &size_.y());
  size_ = drawn_size(size_);
}

Window::~Window() {
  if (display_is_lost()) return;  // with all that was on it
  ImGui::SetCurrentContext(context_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext(context_);
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::is_open() const { return !display_is_lost() && !glfwWindowShouldClose(window_); }

void Window::close() {
  if (!display_is_lost()) glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

void Window::copy(const std::string& text) {
  if (!display_is_lost()) glfwSetClipboardString(window_, text.c_str());
}

WindowInput Window::begin() {
  keys_.clear();
  watch_for_display_loss();
  glfwPollEvents();
  ImGui::SetCurrentContext(context_);
  ImGui_ImplOpenGL3_NewFrame();
  Eigen::Vector2i size = size_;
  if (!display_is_lost()) ImGui_ImplGlfw_NewFrame();
  if (!display_is_lost()) glfwGetFramebufferSize(window_, &size.x(), &size.y());
  ImGuiIO& io = ImGui::GetIO();
  if (display_is_lost()) {  // whose sizes are anything
    io.DisplaySize = {static_cast<float>(size_.x()), static_cast<float>(size_.y())};
    io.DisplayFramebufferScale = {1.0f, 1.0f};
  } else {
    size_ = drawn_size(size);
  }
  ImGui::NewFrame();
  WindowInput input;
  if (display_is_lost()) return input;
  if (!io.WantCaptureKeyboard) input.keys = keys_;
  if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) {  // an open list, which it closes
    std::erase(input.keys, WindowInput::kEscape);
  }
  input.shift = io.KeyShift;
  input.control = io.KeyCtrl;
  if (io.WantCaptureMouse) return input;
  const double half_height = 0.5 * static_cast<double>(io.DisplaySize.y);
  input.pressed = io.MouseClicked[0] || io.MouseClicked[1] || io.MouseClicked[2];
  // The way to where a button was pressed is none that it was held on.
  if (!input.pressed) {
    input.drag = {io.MouseDelta.x / half_height, -io.MouseDelta.y / half_height};
  }
  if (ImGui::IsMousePosValid()) {
    input.pointer = {io.MousePos.x / half_height - io.DisplaySize.x / (2.0 * half_height),
                     1.0 - io.MousePos.y / half_height};
  }
  input.wheel = static_cast<double>(io.MouseWheel);
  input.left = io.MouseDown[0];
  input.right = io.MouseDown[1];
  input.middle = io.MouseDown[2];
  return input;
}

void Window::end(const GlFramebuffer& picture, const GlFramebuffer* inset,
                 const Eigen::Vector2i& inset_at) {
  ImGui::SetCurrentContext(context_);
  ImGui::Render();
  if (display_is_lost()) return;
  picture.show(size().x(), size().y());
  if (inset) inset->show_at(inset_at.x(), inset_at.y());
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
  // Not every display makes us wait.
  const double spent_s = glfwGetTime() - last_frame_s_;
  if (spent_s < kShortestFrame_s) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kShortestFrame_s - spent_s));
  }
  last_frame_s_ = glfwGetTime();
}

}  // namespace sulcus
