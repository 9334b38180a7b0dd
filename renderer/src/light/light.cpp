#include <renderer/light/light.h>

#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <wavelet/base/error.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/tree/descent.h>

namespace haarlight::renderer {

Light::Light(const LightDescription& description, probe::Lookup lookup) {
  place(description.rotate);
  if (!description.probe.empty()) {
    probe::LoadedProbe loaded =
        probe::read_probe(description.probe, probe::parse_mapping(description.mapping), lookup,
                          {.layer = description.layer, .part = description.part});
    m_note = loaded.mapping_reason;
    for (const std::string& note : loaded.notes)
      m_note += "; " + note;
    m_source = loaded.source;
    m_probe.emplace(std::move(loaded.probe));
  }
  if (!description.haar.empty()) {
    m_map.emplace(description.haar, wavelet::SetKind::Light);
    if (!m_map->info().world_frame)
      throw_input_error(description.haar,
                        "holds rotated maps, which belong under the key \"table\"; \"haar\" needs "
                        "the world-frame map of --orientations 1");
  }
  if (!description.table.empty()) {
    m_rotated.emplace(description.table, wavelet::SetKind::Light, wavelet::Check::WhenUsed);
    if (m_rotated->info().world_frame)
      throw_input_error(description.table,
                        "holds the world-frame map, which belongs under the key \"haar\"; "
                        "\"table\" needs rotated maps, --orientations above 1");
  }
  if (!m_probe && !m_map)
    throw_input_error(description.table,
                      "is the only file of the light; it needs \"probe\" or \"haar\", too");
}

void Light::place(double degrees) {
  if (degrees == 0)
    return;
  m_turned = true;
  float s = 0;
  float c = 1;
  sine_cosine(static_cast<float>(std::remainder(degrees, 360.0)) * pi / 180.0F, s, c);
  m_to_world << c, 0, s, 0, 1, 0, -s, 0, c;
}

Rgb Light::radiance(const Vec3& w) const {
  if (m_probe)
    return m_probe->radiance(w);
  const Vec2 p = wavelet::sphere_to_square(w);
  return tree().value(p.x(), p.y()).max(0.0F);
}

void Light::radiance(std::span<const Vec3> directions, std::span<Rgb> out) const {
  if (m_probe)
    return m_probe->radiance(directions, out);
  for (std::size_t i = 0; i < directions.size(); ++i)
    out[i] = radiance(directions[i]);
}

void Light::require_tree() {
  if (!m_map)
    m_map.emplace(probe::ProbeMaps(*m_probe, probe::MapOptions{}, m_source));
}

void Light::require_distribution() {
  if (m_probe && !m_distribution)
    m_distribution.emplace(*m_probe);
}

wavelet::Map Light::map(int most, int least) const {
  if (m_probe) {
    int size = least;
    while (size < most && size < 2 * m_probe->height())
      size *= 2;
    return probe::world_map(*m_probe, size, probe::MapOptions{}.supersample);
  }
  int level = 0;
  while (level < tree().levels && (1 << level) < most)
    ++level;
  wavelet::Map result = tree().reconstruct(level);
  for (float& value : result.rgb)
    value = std::max(value, 0.0F);
  return result;
}

void Light::sample(std::span<const Vec2> points, std::span<probe::LightSample> out) const {
  if (m_distribution)
    return m_distribution->sample(points, out);
  for (std::size_t i = 0; i < points.size(); ++i) {
    wavelet::Descent d;
    d.u1 = points[i].x();
    d.u2 = points[i].y();
    descend_tree(wavelet::TreeDensity::of(tree()), d);
    out[i] = {wavelet::square_to_sphere(wavelet::end_point(d)), d.pdf / wavelet::sphere_area};
  }
}

float Light::pdf(const Vec3& w) const {
  if (m_distribution)
    return m_distribution->pdf(w);
  const Vec2 p = wavelet::sphere_to_square(w);
  wavelet::Descent d;
  follow_tree(wavelet::TreeDensity::of(tree()), p.x(), p.y(), d);
  return d.pdf / wavelet::sphere_area;
}

} // namespace haarlight::renderer
