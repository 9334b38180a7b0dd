#include <view/window_exhibits.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haarlight::view {

using renderer::CameraDescription;

namespace {

template <class Choice>
const Choice& chosen(const std::vector<Choice>& choices, int setting) {
  return choices[static_cast<std::size_t>(setting)];
}

template <class Exhibit>
void read_again(Exhibit& exhibit, const std::string& name, std::vector<News>& news) {
  if (!exhibit.changed())
    return;
  try {
    exhibit.reload();
    news.push_back({name + " was read again", false});
  } catch (const Error& error) {
    news.push_back({std::string(error.what()) + "; the version before is kept", true});
  }
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

} // namespace

Exhibits::Exhibits(const WindowInput& input)
    : m_watched(input.watch), m_light_level(input.light_level),
      m_left(std::make_unique<Side>(Subject{input.scene, {}}, input.watch)),
      m_choices(choices_of(input, scene().light)) {}

void Exhibits::choose(const Settings& settings) {
  exchange(m_left, chosen(m_choices.materials, settings.material));
  exchange(m_right, chosen(m_choices.others, settings.against));
  if (settings.light == m_chosen_light)
    return;
  m_light = settings.light == 0
                ? nullptr
                : std::make_unique<WindowLight>(chosen(m_choices.lights, settings.light),
                                                m_light_level, m_watched);
  m_chosen_light = settings.light;
}

void Exhibits::exchange(std::unique_ptr<Side>& side, const Subject& subject) const {
  if (subject == Subject())
    side.reset();
  else if (!side || side->subject() != subject)
    side = std::make_unique<Side>(subject, m_watched);
}

std::vector<Side*> Exhibits::sides() const {
  std::vector<Side*> all = {m_left.get()};
  if (m_right)
    all.push_back(m_right.get());
  return all;
}

int Exhibits::levels() const {
  if (m_light)
    return m_light->level();
  return std::max(m_left->levels(), m_right ? m_right->levels() : 0);
}

std::vector<SideFigures> Exhibits::figures(bool count) {
  std::vector<SideFigures> figures;
  for (Side* const side : sides()) {
    if (count)
      side->count_accesses();
    figures.push_back(
        {side->subject().name(), side->accesses(), side->milliseconds(), side->texture_bytes()});
  }
  return figures;
}

std::vector<News> Exhibits::read_again() {
  std::vector<News> news;
  for (Side* const side : sides())
    view::read_again(*side, side->subject().name(), news);
  if (m_light)
    view::read_again(*m_light, m_light->name(), news);
  return news;
}

Look Exhibits::completed(Look look, const Area& area, int coarseness) const {
  look.camera = widened(look.camera, scene(), area);
  if (m_light) {
    look.light = m_light->squares();
    look.to_world *= m_light->to_world();
    look.background = m_light->background();
  }
  look.width = std::max(area.width / coarseness, 1);
  look.height = std::max(area.height / coarseness, 1);
  return look;
}

bool Exhibits::draw(const Area& window, const Look& look, int coarseness, float exposure,
                    bool always) {
  const std::vector<Side*> all = sides();
  const int width = std::max(window.width / static_cast<int>(all.size()), 1);
  bool drawn = false;
  int x = 0;
  for (Side* const side : all) {
    const Area area = {x, 0, width, window.height};
    drawn = side->draw(completed(look, area, coarseness), always) || drawn;
    side->show(area, static_cast<double>(exposure));
    x += width;
  }
  return drawn;
}

} // namespace haarlight::view
