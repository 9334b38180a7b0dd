// The reflectance alone, factorised: Lawrence, Rusinkiewicz and Ramamoorthi 2004.

#include "samplers/sampler_factories.h"

#include <brdf/factored_brdf.h>

namespace haarlight::renderer {
namespace {

using brdf::FactoredBrdf;

/// Factorises the reflectance of a material of any representation.
FactoredBrdf factors_of(const Material& material) {
  return FactoredBrdf([&](const Vec3& wo, std::span<const Vec3> directions, std::span<float> out) {
    std::vector<Rgb> values(directions.size());
    material.evaluate(shading_point(Vec3::UnitZ(), wo), directions, values);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = luminance(values[i]);
  });
}

/// The normal, and ω_o in the half plane x ≥ 0, y = 0.
Frame frame_of(const ShadingPoint& point) {
  const Vec3 along = point.wo - point.n.dot(point.wo) * point.n;
  const float length = along.norm();
  if (length < 1e-6F)
    return frame_about(point.n);
  const Vec3 t = along / length;
  return {t, point.n.cross(t), point.n};
}

/// By material; shared, since samplers may outlive their factory.
using SharedFactors = std::shared_ptr<const std::vector<FactoredBrdf>>;

class FactoredSampler : public Sampler {
public:
  FactoredSampler(const std::vector<Material>& materials, SharedFactors factors)
      : m_materials(materials), m_factors(std::move(factors)) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_brdf = &(*m_factors)[static_cast<std::size_t>(&material - m_materials.data())];
    m_frame = frame_of(point);
    m_view = m_brdf->view(m_frame.to_local(point.wo));
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(1, m_points);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const FactoredBrdf::Sample s = m_brdf->sample(m_view, m_points[i]);
      out[i] = {m_frame.to_outer(s.direction), s.pdf};
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_brdf->pdf(m_view, m_frame.to_local(direction));
  }

private:
  const std::vector<Material>& m_materials;
  SharedFactors m_factors;
  const FactoredBrdf* m_brdf = nullptr;
  FactoredBrdf::View m_view;
  Frame m_frame;
  std::vector<Vec2> m_points;
};

SharedFactors factors_of(const std::vector<Material>& materials) {
  std::vector<FactoredBrdf> factors;
  factors.reserve(materials.size());
  for (const Material& material : materials)
    factors.push_back(factors_of(material));
  return std::make_shared<const std::vector<FactoredBrdf>>(std::move(factors));
}

} // namespace

std::unique_ptr<SamplerFactory> make_factored_factory(const LoadedScene& scene,
                                                      const SamplerOptions& /*options*/) {
  return simple_factory<FactoredSampler>(std::cref(scene.materials()),
                                         factors_of(scene.materials()));
}

} // namespace haarlight::renderer
