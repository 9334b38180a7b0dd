#include <view/window_screen.h>

#include <view/window_picture.h>

#include <wavelet/base/error.h>

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

[[noreturn]] void refuse(const std::string& what) {
  const char* reason = nullptr;
  glfwGetError(&reason);
  throw_output_error("window", std::string(what)
                                   .append(reason != nullptr ? std::string(": ") + reason : "")
                                   .append(" (--frame draws without a window)"));
}

/// GLFW while it lives.
struct Library {
  Library() {
    if (glfwInit() != GLFW_TRUE)
      refuse("cannot be opened");
  }
  ~Library() { glfwTerminate(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

enum class Key { Escape, Tab, R };

using Window = std::unique_ptr<GLFWwindow, decltype(&glfwDestroyWindow)>;

Window make_window(int width, int height, const std::string& title) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  Window window(glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr),
                glfwDestroyWindow);
  if (window == nullptr)
    refuse("cannot be opened with OpenGL 3.3");
  glfwMakeContextCurrent(window.get());
  return window;
}

/// Dear ImGui while it lives.
struct Controls {
  explicit Controls(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // else it leaves a file in the current folder
    ImGui::StyleColorsDark();
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ~Controls() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Controls(const Controls&) = delete;
  Controls& operator=(const Controls&) = delete;
};

} // namespace

struct Screen::Parts {
  Library library;
  Window window;
  Controls controls;
  std::array<bool, 3> down = {};

  Parts(int width, int height, const std::string& title)
      : window(make_window(width, height, title)), controls(window.get()) {
    // keys struck while a picture is drawn are not lost
    glfwSetInputMode(window.get(), GLFW_STICKY_KEYS, GLFW_TRUE);
  }

  /// Once for each time the key goes down.
  bool struck(Key key) {
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

Gestures Screen::begin(double patience) {
  if (patience > 0)
    glfwWaitEventsTimeout(patience);
  else
    glfwPollEvents();
  if (m_parts->struck(Key::Escape))
    glfwSetWindowShouldClose(m_parts->window.get(), GLFW_TRUE);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glClearColor(0.08F, 0.08F, 0.08F, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  Gestures found = mouse_gestures();
  found.panel = m_parts->struck(Key::Tab);
  found.reset = m_parts->struck(Key::R);
  return found;
}

void Screen::end(Image* picture) {
  ImGui::Render();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (picture != nullptr)
    *picture = read_window(area());
  glfwSwapBuffers(m_parts->window.get());
}

Area Screen::area() const {
  Area area;
  glfwGetFramebufferSize(m_parts->window.get(), &area.width, &area.height);
  return {0, 0, std::max(area.width, 1), std::max(area.height, 1)};
}

std::string Screen::renderer() const {
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

void Screen::pace(bool paced) { glfwSwapInterval(paced ? 1 : 0); }

} // namespace haarlight::view
