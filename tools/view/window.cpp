#include <view/window.h>

#include <view/window_exhibits.h>
#include <view/window_pace.h>
#include <view/window_screen.h>
#include <view/window_steering.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <chrono>

namespace haarlight::view {
namespace {

constexpr double idle_seconds = 0.1; ///< that a turn takes when nothing happens
using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds poll_interval(200); ///< between looks at watched files

double median(std::vector<double> values) {
  if (values.empty())
    return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Viewer {
public:
  Viewer(const WindowInput& input, const std::function<void(const std::string&)>& note)
      : m_input(input), m_note(note),
        m_screen(input.width, input.height, "haarview: " + base_name(input.scene)),
        m_exhibits(input), m_orbit(m_exhibits.scene().camera), m_settings(settings_of(input)),
        m_shown(m_settings), m_pace(scripted()), m_contents(contents_of(m_exhibits.choices())) {
    m_screen.pace(!scripted());
    m_exhibits.choose(m_settings);
    m_screen.begin(0); // controls show in the turn after the one that lays them out
    show_controls();
    m_screen.end(nullptr);
  }

  WindowReport run() {
    while (m_screen.is_open() && !finished())
      turn_over();
    m_report.renderer = m_screen.renderer();
    m_report.width = m_screen.area().width;
    m_report.height = m_screen.area().height;
    m_report.milliseconds = median(m_times);
    m_report.accesses = m_exhibits.figures(true).front().accesses;
    return std::move(m_report);
  }

private:
  bool scripted() const { return m_input.script.frames.has_value(); }
  bool finished() const { return scripted() && m_frame >= *m_input.script.frames; }
  bool last_frame() const { return scripted() && m_frame + 1 == *m_input.script.frames; }
  bool waits() const { return m_report.reloads + m_report.refusals < m_input.script.reloads; }

  void turn_over() {
    const bool counted = scripted() && !waits();
    const Gestures gestures = m_screen.begin(counted || m_busy ? 0 : idle_seconds);
    steer(gestures, m_exhibits.scene().camera, m_orbit, m_settings);
    poll_files();
    if (counted)
      m_orbit.turn(m_input.script.turn / *m_input.script.frames, 0);
    draw(gestures.moving, counted);
    show_controls();
    take_choices();
    const bool kept = counted && last_frame() && m_input.script.screenshot;
    m_screen.end(kept ? &m_report.picture : nullptr);
    m_frame += counted ? 1 : 0;
  }

  void poll_files() {
    const Clock::time_point now = Clock::now();
    if (!m_input.watch || now < m_next_poll)
      return;
    m_next_poll = now + poll_interval;
    for (const News& news : m_exhibits.read_again()) {
      ++(news.bad ? m_report.refusals : m_report.reloads);
      tell(news);
    }
  }

  void tell(const News& news) {
    m_contents.news = news.text;
    m_contents.bad_news = news.bad;
    m_note(news.text);
  }

  void draw(bool moving, bool always) {
    const Area area = m_screen.area();
    const double full = m_exhibits.milliseconds_per_pixel() * area.width * area.height;
    m_pace.next(moving, full, m_settings.coarseness);
    const Look look = look_of(m_settings, m_orbit, m_input.lamp, m_pace.hurried());
    m_busy = m_exhibits.draw(area, look, m_pace.coarseness(), m_settings.exposure, always);
    if (!m_busy)
      return;
    ++m_report.frames;
    m_times.push_back(m_exhibits.figures(false).front().milliseconds);
  }

  void show_controls() {
    m_contents.sides = m_exhibits.figures(!m_busy || last_frame());
    m_contents.levels = m_exhibits.levels();
    m_settings.level = std::min(m_settings.level, m_contents.levels);
    if (m_settings.panel)
      show_panel(m_contents, m_settings);
    if (m_contents.sides.size() > 1)
      show_names(m_contents.sides, m_screen.area().width);
  }

  /// Opens what was chosen in the panel, or puts the panel back.
  void take_choices() {
    try {
      m_exhibits.choose(m_settings);
      m_shown = m_settings;
    } catch (const Error& error) {
      tell({error.what(), true});
      m_settings.material = m_shown.material;
      m_settings.against = m_shown.against;
      m_settings.light = m_shown.light;
    }
  }

  const WindowInput& m_input;
  const std::function<void(const std::string&)>& m_note;
  Screen m_screen;
  Exhibits m_exhibits;
  Orbit m_orbit;
  Settings m_settings;
  Settings m_shown; ///< as far as all that was chosen could be opened
  Pace m_pace;
  PanelContents m_contents;
  Clock::time_point m_next_poll;
  bool m_busy = true; ///< something had to be drawn
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
