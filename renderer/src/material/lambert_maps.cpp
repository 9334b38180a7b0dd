#include <renderer/material/lambert_maps.h>

#include <wavelet/square/sphere_map.h>

namespace haarlight::renderer {
namespace {

constexpr int taps = 4; ///< along a pixel's side: the only edge is the horizon

float clamped_cosine(const Vec3& n, int x, int y, int size) {
  const float step = 1.0F / static_cast<float>(size * taps);
  float sum = 0;
  for (int j = 0; j < taps; ++j)
    for (int i = 0; i < taps; ++i) {
      const Vec2 p((static_cast<float>(x * taps + i) + 0.5F) * step,
                   (static_cast<float>(y * taps + j) + 0.5F) * step);
      sum += std::max(0.0F, n.dot(wavelet::square_to_sphere(p)));
    }
  return sum / (taps * taps);
}

} // namespace

LambertMaps::LambertMaps(const Rgb& albedo, int size, int theta, int rolls) : m_albedo(albedo) {
  m_info.kind = wavelet::SetKind::Brdf;
  m_info.size = size;
  m_info.columns = theta;
  m_info.rows = rolls;
  m_info.rolls = rolls;
  m_info.cosine = true;
  m_info.units = "sr^-1";
}

wavelet::Map LambertMaps::make(int column, int row) const {
  const float theta_r =
      (static_cast<float>(column) + 0.5F) * 0.5F * pi / static_cast<float>(m_info.columns);
  const float phi = m_info.rolls == 1 ? 0.0F
                                      : (static_cast<float>(row) + 0.5F) * 2.0F * pi /
                                            static_cast<float>(m_info.rolls);
  Vec3 n = Vec3::Zero();
  float sine_theta = 0;
  sine_cosine(theta_r, sine_theta, n.z());
  sine_cosine(phi, n.y(), n.x());
  n.head<2>() *= sine_theta;
  wavelet::Map map(m_info.size);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x)
      map.set(x, y, m_albedo / pi * clamped_cosine(n, x, y, map.size));
  return map;
}

} // namespace haarlight::renderer
