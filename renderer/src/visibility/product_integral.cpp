#include <renderer/visibility/product_integral.h>

#include "film/film_rendering.h"

#include <probe/probe_maps.h>
#include <renderer/visibility/visibility.h>
#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <span>
#include <vector>

namespace haarlight::renderer {
namespace {

using wavelet::MaskedLeaf;

/// Gauss-Legendre points (2 × 2) of a square over which the reflectance is averaged.
constexpr std::size_t points_per_leaf = 4;

/// Squares of this level are not split further.
constexpr int finest_split_level = 14;

/// Squares per pixel at once; further squares are added without splitting. Pixels need less than a
/// tenth of this unless the light has a contrast beyond the precision of float.
constexpr std::size_t most_leaves = 1 << 16;

Vec3 leaf_direction(const MaskedLeaf& leaf, std::size_t point) {
  constexpr float low = 0.21132487F;
  return wavelet::square_to_sphere(
      leaf.square.point((point & 1U) == 0 ? low : 1 - low, (point & 2U) == 0 ? low : 1 - low));
}

/// The light's tree, built from the probe without dropping coefficients if there is one.
class LightTree {
public:
  LightTree(const Light& light, int size) : m_view(light.tree()) {
    if (light.probe() == nullptr)
      return;
    wavelet::CompressOptions options;
    options.threshold.tolerance = 0;
    options.coefficients = wavelet::CoefficientType::Float;
    wavelet::CompressReport report;
    m_tree = compress_map(probe::world_map(*light.probe(), size, probe::MapOptions{}.supersample),
                          options, report);
    m_view = m_tree.view();
  }

  const wavelet::TreeView& view() const { return m_view; }

private:
  wavelet::Tree m_tree;
  wavelet::TreeView m_view;
};

/// Integrates the reflectance times the unoccluded light over the squares of a masked product.
class ReflectedLight {
public:
  ReflectedLight(wavelet::MaskedProduct& masked, float split_fraction)
      : m_masked(masked), m_split_fraction(split_fraction) {}

  /// Per unit square.
  Rgb integral(const ShadingPoint& point, const Material& material,
               std::span<const MaskedLeaf> leaves) {
    m_leaves.assign(leaves.begin(), leaves.end());
    m_sum.setZero();
    look_up(point, material);
    const float largest = m_split_fraction * magnitude();
    while (!m_leaves.empty()) {
      add_or_split(largest);
      m_leaves.swap(m_next);
      look_up(point, material);
    }
    return m_sum.cast<float>();
  }

private:
  void look_up(const ShadingPoint& point, const Material& material) {
    m_directions.clear();
    for (const MaskedLeaf& leaf : m_leaves)
      for (std::size_t k = 0; k < points_per_leaf; ++k)
        m_directions.push_back(leaf_direction(leaf, k));
    m_reflectance.resize(m_directions.size());
    material.evaluate(point, m_directions, m_reflectance);
  }

  Rgb contribution(std::size_t i) const {
    const Rgb* b = m_reflectance.data() + points_per_leaf * i;
    return 0.25F * ((b[0] + b[1]) + (b[2] + b[3])) * light_on(m_leaves[i]);
  }

  /// Bound on the error of a contribution.
  float range(std::size_t i) const {
    const Rgb* b = m_reflectance.data() + points_per_leaf * i;
    const Rgb low = b[0].min(b[1]).min(b[2].min(b[3]));
    const Rgb high = b[0].max(b[1]).max(b[2].max(b[3]));
    return luminance((high - low) * light_on(m_leaves[i]).abs());
  }

  static Rgb light_on(const MaskedLeaf& leaf) {
    return wavelet::to_rgb(leaf.visible_light) * leaf.square.area();
  }

  /// Sum of the contributions' absolute values.
  float magnitude() const {
    double sum = 0;
    for (std::size_t i = 0; i < m_leaves.size(); ++i)
      sum += static_cast<double>(luminance(contribution(i).abs()));
    return static_cast<float>(sum);
  }

  /// Adds leaves, or puts their quadrants into m_next.
  void add_or_split(float largest) {
    m_next.clear();
    for (std::size_t i = 0; i < m_leaves.size(); ++i) {
      if (m_leaves[i].square.level < finest_split_level && m_next.size() + 4 <= most_leaves &&
          range(i) > largest)
        m_masked.split(m_leaves[i], m_next);
      else
        m_sum += contribution(i).cast<double>();
    }
  }

  wavelet::MaskedProduct& m_masked;
  float m_split_fraction;
  Eigen::Array3d m_sum;
  std::vector<MaskedLeaf> m_leaves;
  std::vector<MaskedLeaf> m_next;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_reflectance; ///< points_per_leaf of each leaf
};

class IntegralShader : public PixelShader {
public:
  IntegralShader(const LoadedScene& scene, const ProductIntegralOptions& options,
                 const wavelet::TreeView& light, const VisibilityTrees& visibility)
      : m_scene(scene), m_options(options), m_product(light),
        m_occluders(visibility, scene.shapes().size(), options.levels),
        m_reflected(m_masked, options.split_fraction) {}

  void reset() override {}

  void shade(const PixelHit& seen, const Pass&, PixelSums& sums) override {
    const Light& light = m_scene.light();
    const Material& material = m_scene.material_of(seen.hit.object);
    const ShadingPoint point =
        shading_point(light.to_light(seen.hit.normal), light.to_light(seen.wo));
    const wavelet::ProductTree& product =
        m_product.build(material.reflectance(point), m_options.product);
    ++m_cost.points;
    m_cost.leaves += product.leaf_count();
    const auto leaves = m_masked.build(product, m_occluders.at(seen.hit));
    sums.add(m_reflected.integral(point, material, leaves) * wavelet::sphere_area, true, 0);
  }

private:
  const LoadedScene& m_scene;
  const ProductIntegralOptions& m_options;
  wavelet::AdaptiveProduct m_product;
  wavelet::MaskedProduct m_masked;
  OccluderTrees m_occluders;
  ReflectedLight m_reflected;
};

} // namespace

RenderResult render_product_integral(const LoadedScene& scene,
                                     const ProductIntegralOptions& options, int width, int height,
                                     const RenderProgress& progress) {
  const VisibilityTrees visibility(scene.shapes(), scene.light());
  const LightTree light(scene.light(), options.light_size);
  RenderOptions once;
  once.spp = 1;
  const MakeShader make = [&] {
    return std::make_unique<IntegralShader>(scene, options, light.view(), visibility);
  };
  return render_film(scene, once, make, width, height, progress);
}

} // namespace haarlight::renderer
