#include <view/transfer_window.h>

#include <view/transfer_drawer.h>
#include <view/transfer_light.h>
#include <view/transfer_packing.h>
#include <view/window_screen.h>

#include <wavelet/file/input_file.h>

#include <imgui.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

namespace haarlight::view {

using namespace renderer;
namespace {

constexpr double idle_seconds = 0.1; ///< that a turn takes when nothing happens
constexpr double degrees_per_pixel = 0.4;

/// Pixels of the screen along a side of one of the film's, at first: the window has some 512.
int enlargement(const Transfer& transfer) {
  return std::max(1, 512 / std::max(transfer.width(), transfer.height()));
}

/// The largest part of a window that has a film's shape.
Area fitted(const Area& window, const Transfer& film) {
  const double scale = std::min(static_cast<double>(window.width) / film.width(),
                                static_cast<double>(window.height) / film.height());
  const auto scaled = [&](int side) { return std::max(1, static_cast<int>(scale * side)); };
  const int width = scaled(film.width());
  const int height = scaled(film.height());
  return {(window.width - width) / 2, (window.height - height) / 2, width, height};
}

class TransferViewer {
public:
  TransferViewer(const Transfer& transfer, const SceneDescription& scene,
                 const TransferWindowInput& input)
      : m_transfer(transfer), m_input(input),
        m_points(film_points(scene, transfer.width(), transfer.height())),
        m_light(transfer, scene, m_points), m_screen(enlargement(transfer) * transfer.width(),
                                                     enlargement(transfer) * transfer.height(),
                                                     "haarview: " + base_name(transfer.path())),
        m_drawer(pack_transfer(transfer.trees(), m_points, transfer.width(), transfer.height()),
                 transfer.width(), transfer.height()),
        m_look(input.look), m_panel(!input.bare) {
    m_screen.pace(!scripted());
    m_screen.begin(0); // controls show in the turn after the one that lays them out
    show_panel();
    m_screen.end(nullptr);
  }

  WindowReport run() {
    while (m_screen.is_open() && !(scripted() && m_frame >= *m_input.script.frames))
      turn_over();
    m_report.renderer = m_screen.renderer();
    m_report.width = m_screen.area().width;
    m_report.height = m_screen.area().height;
    m_report.accesses = m_drawer.read().accesses;
    const auto middle = m_times.begin() + static_cast<std::ptrdiff_t>(m_times.size() / 2);
    std::nth_element(m_times.begin(), middle, m_times.end());
    m_report.milliseconds = m_times.empty() ? 0 : *middle;
    return std::move(m_report);
  }

private:
  bool scripted() const { return m_input.script.frames.has_value(); }

  void turn_over() {
    steer(m_screen.begin(scripted() || m_busy ? 0 : idle_seconds));
    m_busy = scripted() || m_times.empty() || m_look != m_drawn;
    if (m_busy)
      draw();
    const Area area = fitted(m_screen.area(), m_transfer);
    m_drawer.show(0, area, static_cast<double>(m_look.exposure));
    if (m_panel)
      show_panel();
    const bool last = scripted() && m_frame + 1 == *m_input.script.frames;
    m_screen.end(last && m_input.script.screenshot ? &m_report.picture : nullptr);
    ++m_frame;
  }

  void steer(const Gestures& gestures) {
    if (gestures.reset)
      m_look.rotate = m_input.look.rotate;
    const double scripted_turn = scripted() ? m_input.script.turn / *m_input.script.frames : 0;
    turn(0, degrees_per_pixel * (gestures.orbit_x + gestures.light_x) + scripted_turn);
    turn(1, degrees_per_pixel * (gestures.orbit_y + gestures.light_y));
    m_panel = m_panel != gestures.panel;
  }

  void turn(std::size_t axis, double degrees) {
    if (degrees != 0)
      m_look.rotate[axis] =
          std::remainder(m_look.rotate[axis] + static_cast<float>(degrees), 360.0F);
  }

  void draw() {
    const auto begin = std::chrono::steady_clock::now();
    const auto& [yaw, pitch, roll] = m_look.rotate;
    if (m_times.empty() || m_look.rotate != m_drawn.rotate)
      m_drawer.set_light(
          m_light.turned(rotation_of(Eigen::Vector3f(yaw, pitch, roll).cast<double>())));
    m_drawer.draw(m_look.level);
    const auto passed = std::chrono::steady_clock::now() - begin;
    m_times.push_back(std::chrono::duration<double, std::milli>(passed).count());
    m_drawn = m_look;
    ++m_report.frames;
  }

  void show_panel() {
    const int finest = std::countr_zero(static_cast<unsigned>(m_transfer.resolution()));
    ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_FirstUseEver);
    ImGui::Begin("haarview", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::Text("%.1f ms", m_times.empty() ? 0 : m_times.back());
    for (const auto& [name, axis] : {std::pair("yaw", 0U), {"pitch", 1U}, {"roll", 2U}})
      ImGui::SliderFloat(name, &m_look.rotate[axis], -180, 180, "%.0f deg");
    ImGui::SliderInt("level", &m_look.level, 0, finest);
    ImGui::SliderFloat("exposure", &m_look.exposure, -8, 8, "%.1f stops");
    ImGui::TextUnformatted("drag: turn the light; R: back; Tab: this panel");
    ImGui::End();
  }

  const Transfer& m_transfer;
  const TransferWindowInput& m_input;
  std::vector<FilmPoint> m_points;
  TransferLight m_light;
  Screen m_screen;
  TransferDrawer m_drawer;
  TransferLook m_look;
  TransferLook m_drawn; ///< once there are times
  bool m_panel;
  bool m_busy = true; ///< something had to be drawn
  int m_frame = 0;
  std::vector<double> m_times;
  WindowReport m_report;
};

} // namespace

WindowReport show_transfer(const Transfer& transfer, const SceneDescription& scene,
                           const TransferWindowInput& input) {
  return TransferViewer(transfer, scene, input).run();
}

} // namespace haarlight::view
