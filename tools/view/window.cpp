#include <view/window.h>

#include <view/controls.h>
#include <view/panes.h>
#include <view/screen.h>
#include <view/transfer.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <imgui.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

namespace haarlight::view {
namespace {

using Clock = std::chrono::steady_clock;
using renderer::Transfer;

constexpr double idle_timeout = 0.1;                    ///< seconds per iteration without events
constexpr std::chrono::milliseconds poll_interval(200); ///< of watched files

double median(std::vector<double> values) {
  if (values.empty())
    return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The window loop: input, picture, controls; until the user closes the window or the script ends.
class WindowLoop {
public:
  WindowLoop(int width, int height, const std::string& title, const WindowScript& script)
      : m_script(script), m_screen(width, height, title) {
    m_screen.set_vsync(!scripted());
  }
  virtual ~WindowLoop() = default;
  WindowLoop(const WindowLoop&) = delete;
  WindowLoop& operator=(const WindowLoop&) = delete;

  WindowReport run() {
    m_screen.begin(0); // Dear ImGui shows controls in the frame after the one that lays them out
    show_controls();
    m_screen.end(nullptr);
    while (m_screen.is_open() && !(scripted() && m_frame >= *m_script.frames))
      iterate();
    m_report.renderer = renderer_name();
    m_report.width = m_screen.viewport().width;
    m_report.height = m_screen.viewport().height;
    m_report.frames = static_cast<int>(m_times.size());
    m_report.milliseconds = median(m_times);
    m_report.accesses = accesses();
    return std::move(m_report);
  }

protected:
  /// Whether frames of the script count.
  virtual bool ready() const { return true; }
  /// @param turn degrees of the script for this frame
  virtual void update(const UserInput& input, double turn) = 0;
  /// Draws if anything changed, or always. @return milliseconds if it drew
  virtual std::optional<double> draw(bool always) = 0;
  virtual void show_controls() = 0;
  virtual double accesses() = 0;

  bool scripted() const { return m_script.frames.has_value(); }
  bool last_frame() const { return scripted() && m_frame + 1 == *m_script.frames; }
  const Screen& screen() const { return m_screen; }
  const std::vector<double>& times() const { return m_times; }
  bool busy() const { return m_busy; }
  WindowReport& report() { return m_report; }
  const WindowReport& report() const { return m_report; }

private:
  void iterate() {
    const bool counts = scripted() && ready();
    const UserInput input = m_screen.begin(counts || m_busy ? 0 : idle_timeout);
    update(input, counts ? m_script.turn / *m_script.frames : 0);
    const std::optional<double> time = draw(counts);
    m_busy = time.has_value();
    if (m_busy)
      m_times.push_back(*time);
    show_controls();
    const bool screenshot = counts && last_frame() && m_script.screenshot;
    m_screen.end(screenshot ? &m_report.screenshot : nullptr);
    m_frame += counts ? 1 : 0;
  }

  const WindowScript& m_script;
  Screen m_screen;
  bool m_busy = true; ///< the last iteration drew
  int m_frame = 0;    ///< of the script
  std::vector<double> m_times;
  WindowReport m_report;
};

class SceneWindow : public WindowLoop {
public:
  SceneWindow(const WindowInput& input, const std::function<void(const std::string&)>& note)
      : WindowLoop(input.width, input.height, "haarview: " + base_name(input.scene), input.script),
        m_input(input), m_note(note), m_panes(input), m_orbit(m_panes.scene().camera),
        m_resolution(scripted()), m_contents(panel_contents(m_panes.choices())) {
    m_settings.second = input.second.empty() ? 0 : 1;
    m_settings.light = input.environment ? 1 : 0;
    m_settings.exposure = static_cast<float>(input.exposure);
    m_settings.level = input.level.value_or(automatic_level);
    m_settings.tolerance = input.tolerance;
    m_settings.panel = input.panel;
    m_panes.choose(m_settings);
    m_opened = m_settings;
  }

private:
  bool ready() const override {
    return report().reloads + report().failed_reloads >= m_input.script.reloads;
  }

  void update(const UserInput& input, double turn) override {
    open_chosen_files();
    apply_input(input, m_panes.scene().camera, m_orbit, m_settings);
    m_moving = input.moving;
    poll_files();
    m_orbit.orbit(turn, 0);
  }

  std::optional<double> draw(bool always) override {
    const Viewport window = screen().viewport();
    const double full_time = m_panes.milliseconds_per_pixel() * window.width * window.height;
    m_resolution.update(m_moving, full_time, m_settings.min_pixel_size);
    const ViewState state =
        view_state(m_settings, m_orbit, m_input.punctual, m_resolution.interactive());
    if (!m_panes.draw(window, state, m_resolution.pixel_size(), m_settings.exposure, always))
      return std::nullopt;
    return m_panes.statistics(false).front().milliseconds;
  }

  void show_controls() override {
    m_contents.panes = m_panes.statistics(!busy() || last_frame());
    m_contents.levels = m_panes.levels();
    m_settings.level = std::min(m_settings.level, m_contents.levels);
    if (m_settings.panel)
      show_panel(m_contents, m_settings);
    if (m_contents.panes.size() > 1)
      show_pane_names(m_contents.panes, screen().viewport().width);
  }

  double accesses() override { return m_panes.statistics(true).front().accesses; }

  /// Opens what was chosen in the panel, or resets the choice if that fails.
  void open_chosen_files() {
    try {
      m_panes.choose(m_settings);
      m_opened = m_settings;
    } catch (const Error& error) {
      show_message({error.what(), true});
      m_settings.material = m_opened.material;
      m_settings.second = m_opened.second;
      m_settings.light = m_opened.light;
    }
  }

  void poll_files() {
    const Clock::time_point now = Clock::now();
    if (!m_input.watch || now < m_next_poll)
      return;
    m_next_poll = now + poll_interval;
    for (const ReloadMessage& message : m_panes.reload_changed()) {
      ++(message.is_error ? report().failed_reloads : report().reloads);
      show_message(message);
    }
  }

  void show_message(const ReloadMessage& message) {
    m_contents.message = message.text;
    m_contents.is_error = message.is_error;
    m_note(message.text);
  }

  const WindowInput& m_input;
  const std::function<void(const std::string&)>& m_note;
  Panes m_panes;
  OrbitCamera m_orbit;
  Settings m_settings;
  Settings m_opened; ///< the last settings whose files could be opened
  ResolutionController m_resolution;
  PanelContents m_contents;
  bool m_moving = false;
  Clock::time_point m_next_poll;
};

class TransferWindow : public WindowLoop {
public:
  TransferWindow(const Transfer& transfer, const renderer::SceneDescription& scene,
                 const TransferWindowInput& input)
      : WindowLoop(magnification(transfer) * transfer.width(),
                   magnification(transfer) * transfer.height(),
                   "haarview: " + base_name(transfer.path()), input.script),
        m_transfer(transfer), m_start(input.state), m_state(input.state), m_panel(input.panel),
        m_points(film_points(scene, transfer.width(), transfer.height())),
        m_light(transfer, scene, m_points),
        m_drawer(pack_transfer(transfer.trees(), m_points, transfer.width(), transfer.height()),
                 transfer.width(), transfer.height()) {}

private:
  /// Screen pixels along a side of a film pixel: the window starts with about 512 pixels a side.
  static int magnification(const Transfer& transfer) {
    return std::max(1, 512 / std::max(transfer.width(), transfer.height()));
  }

  void update(const UserInput& input, double turn) override {
    if (input.reset)
      m_state.rotate = m_start.rotate;
    rotate(0, degrees_per_pixel * (input.orbit_x + input.light_x) + turn);
    rotate(1, degrees_per_pixel * (input.orbit_y + input.light_y));
    m_panel = m_panel != input.toggle_panel;
  }

  void rotate(std::size_t axis, double degrees) {
    if (degrees != 0)
      m_state.rotate[axis] =
          std::remainder(m_state.rotate[axis] + static_cast<float>(degrees), 360.0F);
  }

  std::optional<double> draw(bool always) override {
    std::optional<double> time;
    if (always || !m_drawn || *m_drawn != m_state)
      time = draw_picture();
    m_drawer.show(0, centred_viewport(), static_cast<double>(m_state.exposure));
    return time;
  }

  double draw_picture() {
    const auto begin = Clock::now();
    const auto& [yaw, pitch, roll] = m_state.rotate;
    if (!m_drawn || m_drawn->rotate != m_state.rotate)
      m_drawer.set_light(
          m_light.rotated(renderer::rotation_of(Eigen::Vector3f(yaw, pitch, roll).cast<double>())));
    m_drawer.draw(m_state.level);
    m_drawn = m_state;
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  }

  /// The largest part of the window with the film's aspect ratio.
  Viewport centred_viewport() const {
    const Viewport window = screen().viewport();
    const double scale = std::min(static_cast<double>(window.width) / m_transfer.width(),
                                  static_cast<double>(window.height) / m_transfer.height());
    const int width = std::max(1, static_cast<int>(scale * m_transfer.width()));
    const int height = std::max(1, static_cast<int>(scale * m_transfer.height()));
    return {(window.width - width) / 2, (window.height - height) / 2, width, height};
  }

  void show_controls() override {
    if (!m_panel)
      return;
    begin_panel(ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::Text("%.1f ms", times().empty() ? 0 : times().back());
    for (const auto& [name, axis] : {std::pair("yaw", 0U), {"pitch", 1U}, {"roll", 2U}})
      ImGui::SliderFloat(name, &m_state.rotate[axis], -180, 180, "%.0f deg");
    const int finest = std::countr_zero(static_cast<unsigned>(m_transfer.resolution()));
    ImGui::SliderInt("level", &m_state.level, 0, finest);
    ImGui::SliderFloat("exposure", &m_state.exposure, -8, 8, "%.1f stops");
    ImGui::TextUnformatted("drag: rotate the light; R: reset; Tab: this panel");
    ImGui::End();
  }

  double accesses() override { return m_drawer.read().accesses; }

  const Transfer& m_transfer;
  TransferState m_start;
  TransferState m_state;
  std::optional<TransferState> m_drawn;
  bool m_panel;
  std::vector<renderer::FilmPoint> m_points;
  TransferLight m_light;
  TransferDrawer m_drawer;
};

} // namespace

WindowReport show_window(const WindowInput& input,
                         const std::function<void(const std::string&)>& note) {
  return SceneWindow(input, note).run();
}

WindowReport show_transfer(const Transfer& transfer, const renderer::SceneDescription& scene,
                           const TransferWindowInput& input) {
  return TransferWindow(transfer, scene, input).run();
}

} // namespace haarlight::view
