#include <renderer/transfer/transfer.h>

#include <wavelet/square/sphere_map.h>

#include <cassert>

namespace haarlight::renderer {
namespace {

/// Shapes that may be in the way of light to themselves above the horizon.
bool hides_itself(const Shape& shape) { return std::holds_alternative<Torus>(shape); }

wavelet::ProjectionFactor light_term(const LoadedScene& scene,
                                     const std::vector<float>& variances) {
  return {scene.light().tree(), variances.data()};
}

} // namespace

TransferMaker::TransferMaker(const LoadedScene& scene, const VisibilityTrees& visibility,
                             const Variation& variation, const wavelet::ProjectionOptions& options,
                             const std::vector<float>& light_variances)
    : m_scene(scene), m_visibility(visibility), m_variation(variation), m_options(options),
      m_light(light_term(scene, light_variances)), m_projection(options),
      m_visibilities(scene.description().objects.size()) {}

wavelet::Tree TransferMaker::constant(const Rgb& mean) const {
  wavelet::Tree tree;
  tree.levels = m_options.levels;
  tree.type = m_options.coefficients;
  tree.mean = mean;
  tree.level_begin.assign(static_cast<std::size_t>(tree.levels) + 1, 0);
  tree.coefficients.resize(8);
  return tree;
}

Rgb TransferMaker::background(const FilmPoint& point) const {
  const Light& light = m_scene.light();
  if (m_variation.varying == Varying::Light || !m_scene.description().light.background)
    return Rgb::Zero();
  return light.radiance(light.to_light(-point.wo)) / wavelet::sphere_area;
}

bool TransferMaker::varies(const FilmPoint& point) const {
  if (m_variation.varying != Varying::Material)
    return true;
  const auto object = static_cast<std::size_t>(point.hit.object);
  return m_scene.description().objects[object].material == m_variation.index;
}

void TransferMaker::add_visibilities(const Hit& hit) {
  const auto& objects = m_scene.description().objects;
  const int moved = m_variation.varying == Varying::Object ? m_variation.index : -1;
  for (int i = 0; i < static_cast<int>(objects.size()); ++i) {
    const bool itself = i == hit.object;
    if (i == moved || (itself && !hides_itself(objects[static_cast<std::size_t>(i)].shape)))
      continue;
    wavelet::Tree& tree = m_visibilities[m_terms.size()];
    if (itself)
      m_visibility.own(hit, m_options.levels, m_regions, tree);
    else
      m_visibility.object(i, hit, m_options.levels, m_regions, tree);
    if (!tree.links.empty() || (tree.mean != 1).any())
      m_terms.push_back({tree.view(), nullptr});
  }
}

wavelet::Tree TransferMaker::make(const FilmPoint& point) {
  m_report = {};
  if (point.hit.object < 0)
    return constant(background(point));
  m_terms.clear();
  add_visibilities(point.hit);
  const bool varying = varies(point);
  const bool keeps_light = m_variation.varying != Varying::Light;
  const bool keeps_reflectance =
      m_variation.varying == Varying::Light || m_variation.varying == Varying::Object || !varying;
  if (keeps_light)
    m_terms.push_back(m_light);
  const Light& light = m_scene.light();
  const wavelet::RotatedReflectance reflectance =
      m_scene.material_of(point.hit.object)
          .reflectance(shading_point(light.to_light(point.hit.normal), light.to_light(point.wo)));
  wavelet::Tree tree = m_projection.make(m_terms, keeps_reflectance ? &reflectance : nullptr);
  if (!varying)
    return constant(tree.mean);
  m_report = m_projection.report();
  return tree;
}

} // namespace haarlight::renderer
