// Samplers that draw from product trees: `product` and `product-visibility` build the product of
// the light's tree and the reflectance's averages at each point, in the light's frame;
// `product-table` multiplies the stored trees of the nearest entries of two tables.

#include "samplers/basic_samplers.h"
#include "samplers/sampler_factories.h"
#include "samplers/table_cells.h"
#include "visibility/conservative_visibility.h"

#include <wavelet/product/adaptive_product.h>
#include <wavelet/product/product_tree.h>
#include <wavelet/product/synchronous_product.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>

namespace haarlight::renderer {
namespace {

/// Draws from a product tree. prepare() of the derived sampler sets m_product, and m_frame to the
/// frame of the product's square.
class ProductTreeSampler : public Sampler {
public:
  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    m_descents.resize(out.size());
    if (m_product->empty()) {
      std::ranges::fill(out, DirectionSample{Vec3::UnitZ(), 0});
      return;
    }
    m_product->sample(m_points, m_descents);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {m_frame.to_outer(wavelet::square_to_sphere(wavelet::end_point(m_descents[i]))),
                m_descents[i].pdf / wavelet::sphere_area};
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    const Vec2 p = wavelet::sphere_to_square(m_frame.to_local(direction));
    return m_product->pdf(p.x(), p.y()) / wavelet::sphere_area;
  }

  std::optional<Rgb> unshadowed() const override {
    return Rgb(m_product->integral() * wavelet::sphere_area);
  }

  std::size_t leaves() const override { return m_product->leaf_count(); }

protected:
  const wavelet::ProductTree* m_product = nullptr;
  Frame m_frame;

private:
  std::vector<Vec2> m_points;
  std::vector<wavelet::Descent> m_descents;
};

/// Visibility of squares from one hit, by rays: through the centre of a square and, if that is
/// occluded, through the centres of its quadrants, whose visible fraction counts.
class RayVisibility final : public wavelet::SquareVisibility {
public:
  RayVisibility(const ShapeSet& shapes, const Light& light) : m_shapes(shapes), m_light(light) {}

  /// @param hit must live until the next call; its normal points to the viewer's side
  void set_shading_point(const Hit& hit) { m_hit = &hit; }

  void query_visibility(std::span<const wavelet::Square> squares,
                        std::span<wavelet::SquareView> views) override {
    for (std::size_t i = 0; i < squares.size(); ++i) {
      views[i].seen = 1;
      if (is_visible(squares[i]))
        continue;
      views[i].seen = 0;
      for (unsigned q = 0; q < 4; ++q)
        views[i].seen += is_visible(squares[i].quadrant(q)) ? 0.25F : 0.0F;
    }
  }

private:
  /// Of a square's centre. Directions below the surface count as visible: no light is reflected
  /// from there.
  bool is_visible(const wavelet::Square& square) const {
    const Vec3 w = m_light.to_world(wavelet::square_to_sphere(square.centre()));
    return m_hit->normal.dot(w) <= 0 || !m_shapes.occluded(leave(*m_hit, w));
  }

  const ShapeSet& m_shapes;
  const Light& m_light;
  const Hit* m_hit = nullptr;
};

/// The constants in which `product` and `product-visibility` differ, at points with possible
/// occluders.
struct ProductConfiguration {
  bool conservative_visibility; ///< squares are weighted by their visible fraction from the
                                ///< scene's geometry; else leaves are tested by rays
  /// One of so many samples follows the light alone. Where the product's density is too low, behind
  /// an occluder or at the foot of a lobe, the samples' weights then stay bounded.
  std::size_t samples_per_light_sample;
  /// The default variance bound there over that without occluders.
  float shadow_ratio;
  /// Leaves per sample at most, so that intricate shadows do not cost many times what the samples
  /// do; 0 = any number.
  std::size_t leaves_per_sample;
};

/// Shadows add about ten times the variance that remains without occluders, and the bound goes by
/// its square root.
constexpr ProductConfiguration tested_by_rays = {false, 4, 3, 0};
/// Leaves cost several times as much with occluders, since their visible fractions are computed.
constexpr ProductConfiguration weighted_by_visibility = {true, 16, 6, 25};

/// Fewer samples than this do not lower the number of leaves: a narrow lobe (chrome under grace,
/// with shadows) that 100 leaves do not resolve has a relative error of 5 at 4 samples.
constexpr std::size_t min_samples_for_leaves = 16;

class ProductSampler : public ProductTreeSampler {
public:
  /// @param open,shadowed refinement without and with possible occluders
  ProductSampler(const LoadedScene& scene, const ProductConfiguration& configuration,
                 const wavelet::AdaptiveOptions& open, const wavelet::AdaptiveOptions& shadowed)
      : m_configuration(configuration), m_open(open), m_shadowed(shadowed),
        m_builder(scene.light().tree()), m_light(scene.light()),
        m_rays(scene.shapes(), scene.light()), m_visibility(scene.shapes(), scene.light()) {}

  void reset() override { m_has_previous = false; }

  void prepare(const ShadingPoint& point, const Material& material) override {
    const wavelet::RotatedReflectance reflectance = material.reflectance(point);
    const bool shadowed = point.hit != nullptr;
    if (shadowed && m_configuration.conservative_visibility) {
      m_visibility.set_shading_point(*point.hit);
      m_product = &m_builder.build(reflectance, m_shadowed, &m_visibility,
                                   wavelet::VisibilityTest::Squares);
    } else {
      if (shadowed)
        m_rays.set_shading_point(*point.hit);
      const wavelet::AdaptiveOptions& options = shadowed ? m_shadowed : m_open;
      wavelet::SquareVisibility* visibility = shadowed ? &m_rays : nullptr;
      m_product = m_has_previous ? &m_builder.build_or_reuse(reflectance, options, visibility)
                                 : &m_builder.build(reflectance, options, visibility);
    }
    m_has_previous = true;
    m_mixes = shadowed && !m_product->empty();
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    if (!m_mixes)
      return ProductTreeSampler::sample(points, out);
    const TechniqueSplit split = light_split(out.size());
    const std::size_t light_count = split.count(points, out.size());
    const float fraction = split.fraction();
    const std::span<DirectionSample> from_product = out.first(out.size() - light_count);
    const std::span<DirectionSample> from_light = out.last(light_count);
    ProductTreeSampler::sample(points, from_product);
    for (DirectionSample& s : from_product)
      s = mixed(s.direction, Technique::First, (1 - fraction) * s.pdf,
                fraction * m_light.pdf(s.direction));
    m_light.sample(points, from_light);
    for (DirectionSample& s : from_light)
      s = mixed(s.direction, Technique::Second,
                (1 - fraction) * ProductTreeSampler::pdf(s.direction, 1), fraction * s.pdf);
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    const float own = ProductTreeSampler::pdf(direction, count);
    if (!m_mixes)
      return own;
    const float fraction = light_split(count).fraction();
    return (1 - fraction) * own + fraction * m_light.pdf(direction);
  }

private:
  /// The light's samples: two at least, from which their variance is estimated, but no more than a
  /// quarter; one of two or three.
  TechniqueSplit light_split(std::size_t count) const {
    if (count == 1)
      return {1, 4};
    const std::size_t least = std::clamp<std::size_t>(count / 4, 1, 2);
    return {std::max(count / m_configuration.samples_per_light_sample, least), count};
  }

  /// A sample of the product (First) or of the light (Second).
  /// @param product,light parts of both in the density
  static DirectionSample mixed(const Vec3& direction, Technique technique, float product,
                               float light) {
    const float pdf = product + light;
    const float first = pdf > 0 ? product / pdf : 1.0F;
    return {direction, pdf, technique, {first, first}};
  }

  const ProductConfiguration& m_configuration;
  wavelet::AdaptiveOptions m_open;
  wavelet::AdaptiveOptions m_shadowed;
  wavelet::AdaptiveProduct m_builder;
  LightSampler m_light;
  RayVisibility m_rays;
  detail::ConservativeVisibility m_visibility;
  bool m_has_previous = false;
  bool m_mixes = false;
};

class ProductFactory : public SamplerFactory {
public:
  ProductFactory(const LoadedScene& scene, const SamplerOptions& options,
                 const ProductConfiguration& configuration)
      : m_scene(scene), m_options(options.product), m_configuration(configuration) {}

  std::unique_ptr<Sampler> make(std::size_t count) const override {
    wavelet::AdaptiveOptions open = m_options;
    wavelet::AdaptiveOptions shadowed = m_options;
    if (m_options.variance_bound == 0) {
      open.variance_bound = default_variance_bound(count);
      shadowed.variance_bound = m_configuration.shadow_ratio * open.variance_bound;
    }
    if (m_configuration.leaves_per_sample > 0) {
      const std::size_t affordable =
          m_configuration.leaves_per_sample * std::max(count, min_samples_for_leaves);
      shadowed.max_leaves =
          static_cast<int>(std::min(static_cast<std::size_t>(shadowed.max_leaves), affordable));
    }
    return std::make_unique<ProductSampler>(m_scene, m_configuration, open, shadowed);
  }

private:
  const LoadedScene& m_scene;
  wavelet::AdaptiveOptions m_options;
  const ProductConfiguration& m_configuration;
};

class TableSampler : public ProductTreeSampler {
public:
  explicit TableSampler(const Light& light) : m_table(*light.rotated_table()) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    const TableCells cells = nearest_cells(m_table, point, material);
    m_frame = entry_frame(m_table, cells);
    m_product = &cached(cells, material);
  }

private:
  /// Direct-mapped: neighbouring pixels share products, and memory stays bounded.
  static constexpr std::size_t cache_size = 64;

  struct Cached {
    const Material* material = nullptr;
    TableCells cells;
    wavelet::ProductTree product;
  };

  std::uint32_t hash(const TableCells& cells) const {
    const int index = cells.light_row * m_table.info().columns + cells.light_column;
    return hash_words(
        hash_words(static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(cells.theta)),
        static_cast<std::uint32_t>(cells.roll));
  }

  const wavelet::ProductTree& cached(const TableCells& cells, const Material& material) {
    Cached& entry = m_cache[hash(cells) % cache_size];
    if (entry.material == &material && entry.cells == cells)
      return entry.product;
    const RollEntry roll = roll_entry(*material.roll_table(), cells);
    const wavelet::TreeFactor factors[] = {
        wavelet::TreeFactor(m_table.tree(cells.light_column, cells.light_row)),
        wavelet::TreeFactor(roll.tree, roll.symmetry)};
    entry = {&material, cells, m_builder.build(factors)};
    return entry.product;
  }

  const TreeTable& m_table;
  wavelet::SynchronousProduct m_builder;
  std::vector<Cached> m_cache = std::vector<Cached>(cache_size);
};

} // namespace

float default_variance_bound(std::size_t count) {
  return std::clamp(0.12F / std::sqrt(static_cast<float>(count)), 0.002F, 0.1F);
}

std::unique_ptr<SamplerFactory> make_product_factory(const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return std::make_unique<ProductFactory>(scene, options, tested_by_rays);
}

std::unique_ptr<SamplerFactory> make_product_visibility_factory(const LoadedScene& scene,
                                                                const SamplerOptions& options) {
  return std::make_unique<ProductFactory>(scene, options, weighted_by_visibility);
}

std::unique_ptr<SamplerFactory> make_product_table_factory(const LoadedScene& scene,
                                                           const SamplerOptions& /*options*/) {
  return simple_factory<TableSampler>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
