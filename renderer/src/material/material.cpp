#include <renderer/material/material.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <cmath>

namespace haarlight::renderer {
namespace {

void require_cosine(const std::string& path, const TreeTable& table) {
  if (!table.info().cosine)
    throw_input_error(path, "was made with --no-cosine; rendering needs the cosine in the set");
}

std::shared_ptr<const TreeTable> load_lobes(const std::string& path) {
  auto lobes = std::make_shared<TreeTable>(path, wavelet::SetKind::Brdf);
  require_cosine(path, *lobes);
  if (lobes->info().rolls != 1)
    throw_input_error(path, "holds a set with rolls, which belongs under \"table\"; "
                            "\"haar\" wants one made with --roll 1");
  return lobes;
}

std::unique_ptr<Reflectance> make_truth(const MaterialDescription& description, brdf::Lookup lookup,
                                        const std::shared_ptr<const TreeTable>& lobes) {
  if (description.lambert)
    return lambert_reflectance(*description.lambert);
  if (description.model)
    return analytic_reflectance(*description.model);
  if (!description.brdf.empty())
    return measured_reflectance(brdf::MeasuredBrdf(description.brdf, lookup));
  if (lobes)
    return tree_reflectance(lobes);
  if (description.table.empty())
    return lambert_reflectance(Rgb::Zero());
  throw_input_error(description.table, "is all that material \"" + description.name +
                                           "\" names; it needs \"brdf\" or \"haar\" as well");
}

} // namespace

Material::Material(const MaterialDescription& description, brdf::Lookup lookup)
    : m_name(description.name), m_emission(description.emission) {
  if (!description.haar.empty())
    m_lobes = load_lobes(description.haar);
  if (!description.table.empty()) {
    m_rolls.emplace(description.table, wavelet::SetKind::Brdf, wavelet::Check::WhenUsed);
    require_cosine(description.table, *m_rolls);
  }
  m_truth = make_truth(description, lookup, m_lobes);
}

void Material::need_trees() {
  if (m_pyramid)
    return;
  if (!m_lobes)
    m_lobes = std::make_shared<TreeTable>(*m_truth->maps());
  m_pyramid.emplace(m_lobes->trees());
}

void Material::need_lobe() {
  if (model() == nullptr)
    need_trees();
}

void Material::need_roll_table() {
  if (m_rolls)
    return;
  if (const auto maps = m_truth->roll_maps())
    m_rolls.emplace(*maps);
}

wavelet::RotatedReflectance Material::reflectance(const ShadingPoint& point) const {
  const float c = theta_coordinate(*m_lobes, point);
  wavelet::RotatedReflectance result;
  result.pyramid = &*m_pyramid;
  result.theta_index0 = static_cast<int>(c);
  result.theta_index1 = std::min(result.theta_index0 + 1, m_lobes->info().columns - 1);
  result.blend = c - static_cast<float>(result.theta_index0);
  result.reflection = point.reflection;
  return result;
}

const wavelet::TreeView& Material::lobe(const ShadingPoint& point) const {
  return m_lobes->tree(static_cast<int>(std::lround(theta_coordinate(*m_lobes, point))), 0);
}

Rgb Material::evaluate(const ShadingPoint& point, const Vec3& direction) const {
  Rgb value;
  evaluate(point, std::span(&direction, 1), std::span(&value, 1));
  return value;
}

} // namespace haarlight::renderer
