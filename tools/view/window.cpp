#include <view/window.h>

#include <view/window_choices.h>
#include <view/window_light.h>
#include <view/window_orbit.h>
#include <view/window_panel.h>
#include <view/window_screen.h>
#include <view/window_side.h>

#include <wavelet/error.h>
#include <wavelet/input_file.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

namespace haarlight::view {
namespace {

constexpr double idle_seconds = 0.1;        ///< that a turn takes when nothing happens
constexpr double moving_milliseconds = 60;  ///< for pictures while things are moved
constexpr double still_milliseconds = 3000; ///< and while they are not
constexpr float moving_tolerance = 0.05F;   ///< at least, of a light around, while things are moved
constexpr double poll_seconds = 0.2;        ///< between looks at watched files

using renderer::CameraDescription;
using Clock = std::chrono::steady_clock;

/// About the world's axes, as LightDescription::rotate turns a probe.
Eigen::Matrix3f turn_of(const Settings& settings) {
  constexpr float degree = std::numbers::pi_v<float> / 180;
  const Eigen::AngleAxisf turn(settings.light_turn * degree, Vec3::UnitY());
  const Eigen::AngleAxisf tilt(settings.light_tilt * degree, Vec3::UnitX());
  return (turn * tilt).toRotationMatrix();
}

/// A camera that shows in a narrow area what the film's sides would.
CameraDescription widened(CameraDescription camera, const renderer::SceneDescription& film,
                          const Area& area) {
  const double missing = std::max(1.0, 1.0 * film.width * area.height / film.height / area.width);
  const double half = camera.fov * std::numbers::pi / 360;
  camera.fov = std::atan(missing * std::tan(half)) * 360 / std::numbers::pi;
  camera.height *= missing;
  return camera;
}

double median(std::vector<double> values) {
  if (values.empty())
    return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Choice>
const Choice& chosen(const std::vector<Choice>& choices, int setting) {
  return choices[static_cast<std::size_t>(setting)];
}

class Viewer {
public:
  Viewer(const WindowInput& input, const std::function<void(const std::string&)>& note)
      : m_input(input), m_note(note), m_screen(input.width, input.height, title(input)),
        m_left(std::make_unique<Side>(Subject{input.scene, {}}, input.watch)),
        m_choices(choices_of(input, m_left->description().light)),
        m_orbit(m_left->description().camera) {
    m_settings.against = input.against.empty() ? 0 : 1;
    m_settings.light = input.lighting == Lighting::Environment ? 1 : 0;
    m_settings.exposure = static_cast<float>(input.exposure);
    m_settings.level = input.level.value_or(automatic_level);
    m_settings.tolerance = input.tolerance;
    m_settings.panel = !input.bare;
    m_screen.pace(!scripted());
    m_coarseness = scripted() ? 1 : 8;
    m_contents.materials = names_of(m_choices.materials);
    m_contents.others = names_of(m_choices.others);
    m_contents.lights = names_of(m_choices.lights);
    choose(m_settings);
    m_shown = m_settings;
  }

  WindowReport run() {
    while (m_screen.is_open() && !finished())
      turn_over();
    m_report.renderer = m_screen.renderer();
    m_report.width = m_screen.area().width;
    m_report.height = m_screen.area().height;
    m_report.milliseconds = median(m_times);
    m_left->count_accesses();
    m_report.accesses = m_left->accesses();
    return std::move(m_report);
  }

private:
  static std::string title(const WindowInput& input) {
    return std::string("haarview: ").append(base_name(input.scene));
  }

  bool scripted() const { return m_input.script.frames.has_value(); }
  bool finished() const { return scripted() && m_frame >= *m_input.script.frames; }
  bool last_frame() const { return scripted() && m_frame + 1 == *m_input.script.frames; }
  bool waits() const { return m_report.reloads + m_report.refusals < m_input.script.reloads; }

  void turn_over() {
    const bool counted = scripted() && !waits();
    steer(m_screen.begin(counted || m_busy ? 0 : idle_seconds));
    poll_files();
    if (counted)
      m_orbit.turn(m_input.script.turn / *m_input.script.frames, 0);
    if (!scripted())
      choose_coarseness();
    m_busy = draw(counted);
    tell();
    take_choices();
    const bool kept = counted && last_frame() && m_input.script.screenshot;
    m_screen.end(kept ? &m_report.picture : nullptr);
    m_frame += counted ? 1 : 0;
  }

  void steer(const Gestures& gestures) {
    if (gestures.reset) {
      m_orbit = Orbit(m_left->description().camera);
      m_settings.light_turn = m_settings.light_tilt = 0;
    }
    m_moved = std::exchange(m_moving, gestures.moving && !scripted());
    m_orbit.turn(-0.4 * gestures.orbit_x, 0.4 * gestures.orbit_y);
    m_orbit.enlarge(std::pow(1.1, gestures.wheel));
    const auto moved = [](float angle, double pixels, float most) {
      return std::clamp(angle + 0.4F * static_cast<float>(pixels), -most, most);
    };
    const float turn = moved(m_settings.light_turn, gestures.light_x, 1000);
    m_settings.light_turn = std::remainder(turn, 360.0F);
    m_settings.light_tilt = moved(m_settings.light_tilt, gestures.light_y, 90);
    m_settings.panel = m_settings.panel != gestures.panel;
  }

  void poll_files() {
    const Clock::time_point now = Clock::now();
    if (!m_input.watch || now < m_next_poll)
      return;
    m_next_poll = now + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(poll_seconds));
    for (Side* side : {m_left.get(), m_right.get()})
      if (side != nullptr && side->changed())
        reload(*side, side->subject().name());
    if (m_light && m_light->changed())
      reload(*m_light, m_light->name());
  }

  template <class Reloaded>
  void reload(Reloaded& what, const std::string& name) {
    try {
      what.reload();
      ++m_report.reloads;
      tell_news(name + " was read again", false);
    } catch (const Error& error) {
      ++m_report.refusals;
      tell_news(std::string(error.what()) + "; the version before is kept", true);
    }
  }

  void tell_news(const std::string& text, bool bad) {
    m_contents.news = text;
    m_contents.bad_news = bad;
    m_note(text);
  }

  /// @return whether anything had to be drawn anew
  bool draw(bool always) {
    const Area whole = m_screen.area();
    const int width = m_right ? whole.width / 2 : whole.width;
    bool drawn = false;
    int x = 0;
    for (Side* side : {m_left.get(), m_right.get()}) {
      if (side == nullptr)
        continue;
      const Area area = {x, 0, std::max(width, 1), whole.height};
      drawn = side->draw(look_in(area), always) || drawn;
      side->show(area, static_cast<double>(m_settings.exposure));
      x += width;
    }
    if (drawn) {
      ++m_report.frames;
      m_times.push_back(m_left->milliseconds());
    }
    return drawn;
  }

  Look look_in(const Area& area) const {
    Look look;
    look.camera = widened(m_orbit.camera(), m_left->description(), area);
    look.lamp = m_input.lamp;
    look.to_world = turn_of(m_settings);
    look.lamp.place = look.to_world * look.lamp.place;
    if (m_light) {
      look.light = m_light->squares();
      look.to_world *= m_light->to_world();
      look.background = m_light->background();
    }
    look.tolerance = std::max(m_settings.tolerance, m_moving ? moving_tolerance : 0);
    look.level = m_settings.level;
    look.width = std::max(area.width / m_coarseness, 1);
    look.height = std::max(area.height / m_coarseness, 1);
    return look;
  }

  /// Coarse while things are moved, then finer step by step while there is time for it.
  void choose_coarseness() {
    const double full = milliseconds_of_window();
    const int finer = (m_coarseness + 1) / 2;
    if (m_moving)
      m_coarseness =
          static_cast<int>(std::ceil(std::clamp(std::sqrt(full / moving_milliseconds), 1.0, 8.0)));
    else if (!m_moved && full <= still_milliseconds * finer * finer)
      m_coarseness = finer;
    m_coarseness = std::max(m_coarseness, m_settings.coarseness);
  }

  /// That pictures of its full resolution would take.
  double milliseconds_of_window() const {
    const Area area = m_screen.area();
    return m_left->milliseconds_per_pixel() * area.width * area.height;
  }

  void tell() {
    m_contents.sides.clear();
    m_contents.levels = m_light ? m_light->level() : 0;
    for (Side* side : {m_left.get(), m_right.get()}) {
      if (side == nullptr)
        continue;
      if (!m_busy || last_frame()) // not while things move: reading back takes time
        side->count_accesses();
      if (!m_light)
        m_contents.levels = std::max(m_contents.levels, side->levels());
      m_contents.sides.push_back(
          {side->subject().name(), side->accesses(), side->milliseconds(), side->texture_bytes()});
    }
    m_settings.level = std::min(m_settings.level, m_contents.levels);
    if (m_settings.panel)
      show_panel(m_contents, m_settings);
    if (m_right)
      show_names(m_contents.sides, m_screen.area().width);
  }

  /// Opens what was chosen in the panel, or puts the panel back.
  void take_choices() {
    try {
      choose(m_settings);
      m_shown = m_settings;
    } catch (const Error& error) {
      tell_news(error.what(), true);
      m_settings.material = m_shown.material;
      m_settings.against = m_shown.against;
      m_settings.light = m_shown.light;
    }
  }

  void choose(const Settings& settings) {
    exchange(m_left, chosen(m_choices.materials, settings.material));
    exchange(m_right, chosen(m_choices.others, settings.against));
    if (settings.light != m_shown.light)
      m_light = settings.light == 0
                    ? nullptr
                    : std::make_unique<WindowLight>(chosen(m_choices.lights, settings.light),
                                                    m_input.light_level, m_input.watch);
  }

  void exchange(std::unique_ptr<Side>& side, const Subject& subject) {
    if (subject == Subject())
      side.reset();
    else if (!side || side->subject() != subject)
      side = std::make_unique<Side>(subject, m_input.watch);
  }

  const WindowInput& m_input;
  const std::function<void(const std::string&)>& m_note;
  Screen m_screen;
  std::unique_ptr<Side> m_left;
  std::unique_ptr<Side> m_right;
  std::unique_ptr<WindowLight> m_light;
  WindowChoices m_choices;
  Orbit m_orbit;
  Settings m_settings;
  PanelContents m_contents;
  Settings m_shown; ///< as far as all that was chosen could be opened
  Clock::time_point m_next_poll;
  bool m_moving = false;
  bool m_moved = false; ///< a turn before
  int m_coarseness = 1; ///< of the window's pixels, along a side of one of the pictures'
  bool m_busy = true;
  int m_frame = 0;
  std::vector<double> m_times;
  WindowReport m_report;
};

} // namespace

WindowReport show_window(const WindowInput& input,
                         const std::function<void(const std::string&)>& note) {
  return Viewer(input, note).run();
}

} // namespace haarlight::view
