#include <view/screen.h>

#include <wavelet/base/error.h>

#include <image/png.h>

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

namespace haarlight::view {
namespace {

[[noreturn]] void throw_no_window(const std::string& problem) {
  const char* reason = nullptr;
  glfwGetError(&reason);
  throw_output_error("window", std::string(problem)
                                   .append(reason != nullptr ? std::string(": ") + reason : "")
                                   .append(" (--image draws without a window)"));
}

using GlfwWindow = std::unique_ptr<GLFWwindow, decltype(&glfwDestroyWindow)>;

GlfwWindow make_window(int width, int height, const std::string& title) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  GlfwWindow window(glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr),
                    glfwDestroyWindow);
  if (window == nullptr)
    throw_no_window("cannot be opened with OpenGL 3.3");
  glfwMakeContextCurrent(window.get());
  return window;
}

enum class Key { Escape, Tab, R };

/// After ImGui::NewFrame().
UserInput mouse_input() {
  const ImGuiIO& io = ImGui::GetIO();
  UserInput input;
  input.moving = ImGui::IsAnyMouseDown();
  if (io.WantCaptureMouse)
    return input;
  const auto drag = [&](ImGuiMouseButton button, double& x, double& y) {
    if (!ImGui::IsMouseDown(button))
      return;
    x = static_cast<double>(io.MouseDelta.x);
    y = static_cast<double>(io.MouseDelta.y);
  };
  drag(ImGuiMouseButton_Left, input.orbit_x, input.orbit_y);
  drag(ImGuiMouseButton_Right, input.light_x, input.light_y);
  input.wheel = static_cast<double>(io.MouseWheel);
  input.moving = input.moving || input.wheel != 0;
  return input;
}

/// The back buffer as linear values of its 8-bit codes.
Image read_window(const Viewport& viewport) {
  const auto width = static_cast<std::size_t>(viewport.width);
  const std::size_t row = 3 * width;
  std::vector<unsigned char> codes(row * static_cast<std::size_t>(viewport.height));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, viewport.width, viewport.height, GL_RGB, GL_UNSIGNED_BYTE, codes.data());
  Image picture(viewport.width, viewport.height);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::size_t y = static_cast<std::size_t>(viewport.height) - 1 - i / row;
    picture.rgb[y * row + i % row] = image::srgb_value(codes[i]);
  }
  return picture;
}

} // namespace

struct Screen::Parts {
  /// Initializes GLFW.
  struct GlfwLibrary {
    GlfwLibrary() {
      if (glfwInit() != GLFW_TRUE)
        throw_no_window("cannot be opened");
    }
    ~GlfwLibrary() { glfwTerminate(); }
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;
  };

  /// Initializes Dear ImGui.
  struct ImGuiLibrary {
    explicit ImGuiLibrary(GLFWwindow* window) {
      ImGui::CreateContext();
      ImGui::GetIO().IniFilename = nullptr; // else it writes a file to the current folder
      ImGui::StyleColorsDark();
      ImGui_ImplGlfw_InitForOpenGL(window, true);
      ImGui_ImplOpenGL3_Init("#version 330 core");
    }
    ~ImGuiLibrary() {
      ImGui_ImplOpenGL3_Shutdown();
      ImGui_ImplGlfw_Shutdown();
      ImGui::DestroyContext();
    }
    ImGuiLibrary(const ImGuiLibrary&) = delete;
    ImGuiLibrary& operator=(const ImGuiLibrary&) = delete;
  };

  GlfwLibrary glfw;
  GlfwWindow window;
  ImGuiLibrary imgui;
  std::array<bool, 3> down = {};

  Parts(int width, int height, const std::string& title)
      : window(make_window(width, height, title)), imgui(window.get()) {
    // keys pressed while a picture is drawn are not lost
    glfwSetInputMode(window.get(), GLFW_STICKY_KEYS, GLFW_TRUE);
  }

  /// True once for each time the key goes down.
  bool pressed(Key key) {
    static constexpr std::array codes = {GLFW_KEY_ESCAPE, GLFW_KEY_TAB, GLFW_KEY_R};
    const auto i = static_cast<std::size_t>(key);
    const bool before = std::exchange(down[i], glfwGetKey(window.get(), codes[i]) == GLFW_PRESS);
    return down[i] && !before;
  }
};

Screen::Screen(int width, int height, const std::string& title)
    : m_parts(std::make_unique<Parts>(width, height, title)) {}

Screen::~Screen() = default;

bool Screen::is_open() const { return glfwWindowShouldClose(m_parts->window.get()) == GLFW_FALSE; }

UserInput Screen::begin(double timeout) {
  if (timeout > 0)
    glfwWaitEventsTimeout(timeout);
  else
    glfwPollEvents();
  if (m_parts->pressed(Key::Escape))
    glfwSetWindowShouldClose(m_parts->window.get(), GLFW_TRUE);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glClearColor(0.08F, 0.08F, 0.08F, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  UserInput input = mouse_input();
  input.toggle_panel = m_parts->pressed(Key::Tab);
  input.reset = m_parts->pressed(Key::R);
  return input;
}

void Screen::end(Image* screenshot) {
  ImGui::Render();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (screenshot != nullptr)
    *screenshot = read_window(viewport());
  glfwSwapBuffers(m_parts->window.get());
}

Viewport Screen::viewport() const {
  Viewport result;
  glfwGetFramebufferSize(m_parts->window.get(), &result.width, &result.height);
  return {0, 0, std::max(result.width, 1), std::max(result.height, 1)};
}

void Screen::set_vsync(bool on) { glfwSwapInterval(on ? 1 : 0); }

} // namespace haarlight::view
