#include <probe/probe_maps.h>

#include "maps/map_rotation.h"

#include <wavelet/base/error.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cassert>

namespace haarlight::probe {

Frame light_frame(int i, int j, int orientations) {
  const auto cells = static_cast<float>(orientations);
  return frame_about(wavelet::square_to_sphere(
      Vec2((static_cast<float>(i) + 0.5F) / cells, (static_cast<float>(j) + 0.5F) / cells)));
}

Frame carried_frame(const Frame& frame, const Vec3& w) {
  // Rodrigues about n × w; within a cell the two axes are never opposite.
  const Vec3 axis = frame.n.cross(w);
  const float cosine = frame.n.dot(w);
  const float k = 1.0F / std::max(1.0F + cosine, 1e-6F);
  const auto carry = [&](const Vec3& v) -> Vec3 {
    return v * cosine + axis.cross(v) + axis * (axis.dot(v) * k);
  };
  return {carry(frame.t), carry(frame.b), w};
}

int default_map_size(const Probe& probe, int orientations) {
  if (orientations > 1)
    return 128;
  int size = 512;
  while (size < 2048 && size < 3.2 * probe.width())
    size *= 2;
  return size;
}

ProbeMaps::ProbeMaps(const Probe& probe, const MapOptions& options, const Provenance& source)
    : m_options(options), m_integral(probe.integral()) {
  if (!m_integral.allFinite())
    throw_input_error(probe.path(), "holds radiances whose integral over the sphere exceeds the "
                                    "largest single-precision number; the picture must be scaled "
                                    "down");
  if (m_options.size == 0)
    m_options.size = default_map_size(probe, m_options.orientations);
  assert(m_options.size >= 4 && m_options.orientations >= 1 && m_options.supersample >= 1);
  describe(source, probe.mapping());
  if (m_options.orientations == 1) {
    m_world = world_map(probe, m_options.size, m_options.supersample);
    return;
  }
  const wavelet::Map full = world_map(probe, default_map_size(probe, 1), m_options.supersample);
  m_level = make_level(full, matching_level_size(m_options, full.size));
}

void ProbeMaps::describe(const Provenance& source, Mapping mapping) {
  const bool world = m_options.orientations == 1;
  m_info.kind = wavelet::SetKind::Light;
  m_info.size = m_options.size;
  m_info.columns = m_options.orientations;
  m_info.rows = m_options.orientations;
  m_info.world_frame = world;
  m_info.frame = world ? "world: right +x, up +y, forward -z"
                       : "column i, row j of M x M: n = square_to_sphere((i+1/2)/M, (j+1/2)/M) in "
                         "world axes (right +x, up +y, forward -z), t and b of Duff et al. 2017 "
                         "about n; averaged over the cell";
  m_info.units = "radiance of the probe";
  m_info.provenance = source;
  m_info.provenance.set("mapping", mapping_name(mapping));
  m_info.provenance.set("orientations", std::to_string(m_options.orientations));
  m_info.provenance.set("supersample", std::to_string(m_options.supersample));
  m_info.provenance.set("version", version_text());
}

wavelet::Map ProbeMaps::make(int column, int row) const {
  if (m_options.orientations == 1)
    return m_world;
  return rotated_map(m_level, m_options, column, row);
}

std::optional<Rgb> ProbeMaps::integral(int /*column*/, int /*row*/) const { return m_integral; }

} // namespace haarlight::probe
