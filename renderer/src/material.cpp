#include <renderer/material.h>

#include <renderer/lambert_maps.h>

#include <brdf/brdf_maps.h>
#include <wavelet/error.h>
#include <wavelet/sphere_map.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haarlight::renderer {

ShadingPoint shading_point(const Vec3& n, const Vec3& wo) {
  return {n, wo, reflection_frame(n, wo)};
}

Material::Material(const MaterialDescription& description, brdf::Lookup lookup)
    : m_name(description.name), m_lambert(description.lambert) {
  if (!description.brdf.empty())
    m_measured.emplace(description.brdf, lookup);
  if (!description.haar.empty()) {
    m_lobes.emplace(description.haar, wavelet::SetKind::Brdf);
    require_cosine(description.haar, *m_lobes);
    if (m_lobes->info().rolls != 1)
      throw_input_error(description.haar, "holds a set with rolls, which belongs under \"table\"; "
                                          "\"haar\" wants one made with --roll 1");
  }
  if (!description.table.empty()) {
    m_rolls.emplace(description.table, wavelet::SetKind::Brdf, wavelet::Check::WhenUsed);
    require_cosine(description.table, *m_rolls);
  }
  if (!m_lambert && !m_measured && !m_lobes)
    throw_input_error(description.table, "is all that material \"" + m_name +
                                             "\" names; it needs \"brdf\" or \"haar\" as well");
}

void Material::require_cosine(const std::string& path, const TreeTable& table) const {
  if (!table.info().cosine)
    throw_input_error(path, "was made with --no-cosine; rendering needs the cosine in the set");
}

void Material::need_trees() {
  if (m_pyramid)
    return;
  if (!m_lobes && m_measured)
    m_lobes.emplace(brdf::BrdfMaps(*m_measured));
  if (!m_lobes)
    m_lobes.emplace(LambertMaps(*m_lambert));
  m_pyramid.emplace(m_lobes->trees());
}

void Material::need_roll_table() {
  if (!m_rolls && m_lambert)
    m_rolls.emplace(LambertMaps(*m_lambert, 32, 16, 32));
}

/// Where a point's θ_r lies among the centres of the set's cells, in cells.
float Material::theta_coordinate(const ShadingPoint& point) const {
  const float theta_r = arctangent(point.reflection.sin_theta_r, point.reflection.cos_theta_r);
  const float cells = static_cast<float>(m_lobes->info().columns);
  return std::clamp(theta_r * (2.0F / pi) * cells - 0.5F, 0.0F, cells - 1.0F);
}

wavelet::RotatedReflectance Material::reflectance(const ShadingPoint& point) const {
  const float c = theta_coordinate(point);
  wavelet::RotatedReflectance result;
  result.pyramid = &*m_pyramid;
  result.entry0 = static_cast<int>(c);
  result.entry1 = std::min(result.entry0 + 1, m_lobes->info().columns - 1);
  result.blend = c - static_cast<float>(result.entry0);
  result.reflection = point.reflection;
  return result;
}

const wavelet::TreeView& Material::lobe(const ShadingPoint& point) const {
  return m_lobes->tree(static_cast<int>(std::lround(theta_coordinate(point))), 0);
}

Rgb Material::from_trees(const ShadingPoint& point, const Vec3& direction) const {
  if (point.n.dot(direction) <= 0)
    return Rgb::Zero();
  const Vec2 p = wavelet::sphere_to_square(point.reflection.frame.to_local(direction));
  const float c = theta_coordinate(point);
  const int first = static_cast<int>(c);
  const int second = std::min(first + 1, m_lobes->info().columns - 1);
  const Rgb a = m_lobes->tree(first, 0).value(p.x(), p.y());
  const Rgb b = m_lobes->tree(second, 0).value(p.x(), p.y());
  return (a + (b - a) * (c - static_cast<float>(first))).max(0.0F);
}

void Material::evaluate_measured(const ShadingPoint& point, std::span<const Vec3> directions,
                                 std::span<Rgb> out) const {
  const Frame frame = frame_about(point.n);
  const Vec3 local_wo = frame.to_local(point.wo);
  brdf::DirectionBatch batch;
  std::array<Float4, brdf::batch_capacity> values;
  for (std::size_t i = 0; i < directions.size(); i += brdf::batch_capacity) {
    batch.count =
        static_cast<int>(std::min<std::size_t>(brdf::batch_capacity, directions.size() - i));
    for (int k = 0; k < batch.count; ++k) {
      const Vec3 local_wi = frame.to_local(directions[i + static_cast<std::size_t>(k)]);
      for (int axis = 0; axis < 3; ++axis) {
        batch.wi[axis][k] = local_wi[axis];
        batch.wo[axis][k] = local_wo[axis];
      }
    }
    m_measured->evaluate(batch, values.data());
    for (int k = 0; k < batch.count; ++k)
      out[i + static_cast<std::size_t>(k)] =
          wavelet::to_rgb(values[static_cast<std::size_t>(k)]) * std::max(0.0F, batch.wi[2][k]);
  }
}

void Material::evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                        std::span<Rgb> out) const {
  if (m_measured) {
    evaluate_measured(point, directions, out);
    return;
  }
  for (std::size_t i = 0; i < directions.size(); ++i)
    out[i] = m_lambert ? Rgb(*m_lambert / pi * std::max(0.0F, point.n.dot(directions[i])))
                       : from_trees(point, directions[i]);
}

Rgb Material::evaluate(const ShadingPoint& point, const Vec3& direction) const {
  Rgb value;
  evaluate(point, std::span(&direction, 1), std::span(&value, 1));
  return value;
}

} // namespace haarlight::renderer
