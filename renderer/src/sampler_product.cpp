// The world-frame product: one light tree, and the reflectance's averages on the fly.

#include "sampler_kinds.h"

#include <wavelet/sphere_map.h>

namespace haarlight::renderer {
namespace {

class ProductSampler : public Sampler {
public:
  ProductSampler(const Light& light, const wavelet::AdaptiveOptions& options)
      : m_builder(light.tree()), m_options(options) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_product = &m_builder.build(material.reflectance(point), m_options);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (m_product->empty()) {
        out[i] = {Vec3::UnitZ(), 0};
        continue;
      }
      const wavelet::Descent d = m_product->sample(m_points[i].x(), m_points[i].y());
      out[i] = {wavelet::square_to_sphere(wavelet::end_point(d)), d.pdf / wavelet::sphere_area};
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    const Vec2 p = wavelet::sphere_to_square(direction);
    return m_product->pdf(p.x(), p.y()) / wavelet::sphere_area;
  }

  std::optional<Rgb> unshadowed() const override {
    return Rgb(m_product->integral() * wavelet::sphere_area);
  }

  std::size_t leaves() const override { return m_product->leaf_count(); }

private:
  wavelet::AdaptiveProduct m_builder;
  wavelet::AdaptiveOptions m_options;
  const wavelet::ProductTree* m_product = nullptr;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<Sampler> make_product_sampler(const Light& light,
                                              const wavelet::AdaptiveOptions& options) {
  return std::make_unique<ProductSampler>(light, options);
}

} // namespace haarlight::renderer
