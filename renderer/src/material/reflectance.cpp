#include <renderer/material/reflectance.h>

#include <brdf/brdf_maps.h>
#include <brdf/tabulate.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haarlight::renderer {
namespace {

/// Without highlight, so that its routine is the cosine's.
brdf::BlinnPhong cosine_model(const Rgb& albedo) {
  brdf::BlinnPhong model;
  model.diffuse = albedo;
  model.specular = Rgb::Zero();
  return model;
}

class Lambert : public Reflectance {
public:
  explicit Lambert(const Rgb& albedo) : m_albedo(albedo), m_model(cosine_model(albedo)) {}

  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const override {
    for (std::size_t i = 0; i < directions.size(); ++i)
      out[i] = m_albedo / pi * std::max(0.0F, point.n.dot(directions[i]));
  }

  std::unique_ptr<wavelet::MapSource> maps() const override {
    return std::make_unique<LambertMaps>(m_albedo);
  }
  std::unique_ptr<wavelet::MapSource> roll_maps() const override {
    return std::make_unique<LambertMaps>(m_albedo, 32, 16, 32);
  }

  const brdf::AnalyticBrdf* model() const override { return &m_model; }

private:
  Rgb m_albedo;
  brdf::AnalyticBrdf m_model;
};

class Measured : public Reflectance {
public:
  explicit Measured(brdf::MeasuredBrdf brdf) : m_brdf(std::move(brdf)) {}

  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const override {
    const Frame frame = frame_about(point.n);
    const Vec3 local_wo = frame.to_local(point.wo);
    for (std::size_t i = 0; i < directions.size(); i += brdf::batch_capacity) {
      const std::size_t count = std::min<std::size_t>(brdf::batch_capacity, directions.size() - i);
      evaluate_batch(frame, local_wo, directions.subspan(i, count), out.subspan(i, count));
    }
  }

  std::unique_ptr<wavelet::MapSource> maps() const override {
    return std::make_unique<brdf::BrdfMaps>(m_brdf);
  }

private:
  void evaluate_batch(const Frame& frame, const Vec3& local_wo, std::span<const Vec3> directions,
                      std::span<Rgb> out) const {
    brdf::DirectionBatch batch;
    std::array<Float4, brdf::batch_capacity> values;
    batch.count = static_cast<int>(directions.size());
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const Vec3 local_wi = frame.to_local(directions[k]);
      for (int axis = 0; axis < 3; ++axis) {
        batch.wi[axis][k] = local_wi[axis];
        batch.wo[axis][k] = local_wo[axis];
      }
    }
    m_brdf.evaluate(batch, values.data());
    for (std::size_t k = 0; k < directions.size(); ++k)
      out[k] = wavelet::to_rgb(values[k]) * std::max(0.0F, batch.wi[2][k]);
  }

  brdf::MeasuredBrdf m_brdf;
};

/// Pixels along the side of a model's maps: fewer where its lobe is wide.
int map_size(const brdf::AnalyticBrdf& model) {
  const double roughness = std::visit(
      [](const auto& m) {
        if constexpr (requires { m.roughness; })
          return m.roughness;
        else
          return std::sqrt(2 / (m.exponent + 2)); // Walter et al. 2007
      },
      model);
  return roughness < 0.1 ? 512 : roughness < 0.2 ? 256 : 128;
}

class Analytic : public Reflectance {
public:
  explicit Analytic(const brdf::AnalyticBrdf& model) : m_model(model) {}

  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const override {
    const Frame frame = frame_about(point.n);
    const Vec3 local_wo = frame.to_local(point.wo);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const Vec3 local_wi = frame.to_local(directions[i]);
      out[i] = brdf::evaluate(m_model, local_wi, local_wo) * std::max(0.0F, local_wi.z());
    }
  }

  /// By way of a table, whose maps overlook no lobe however narrow.
  std::unique_ptr<wavelet::MapSource> maps() const override {
    brdf::BrdfMapOptions options;
    options.size = map_size(m_model);
    return tabulated(options);
  }
  std::unique_ptr<wavelet::MapSource> roll_maps() const override {
    brdf::BrdfMapOptions options;
    options.size = 64; // as tables are: thousands of maps
    options.theta = 32;
    options.roll = 32;
    return tabulated(options);
  }

  const brdf::AnalyticBrdf* model() const override { return &m_model; }

private:
  std::unique_ptr<wavelet::MapSource> tabulated(const brdf::BrdfMapOptions& options) const {
    return std::make_unique<brdf::BrdfMaps>(brdf::MeasuredBrdf(brdf::tabulate(m_model)), options);
  }

  brdf::AnalyticBrdf m_model;
};

class Trees : public Reflectance {
public:
  explicit Trees(std::shared_ptr<const TreeTable> lobes) : m_lobes(std::move(lobes)) {}

  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const override {
    const float c = theta_coordinate(*m_lobes, point);
    const int first = static_cast<int>(c);
    const wavelet::TreeView& a = m_lobes->tree(first, 0);
    const wavelet::TreeView& b = m_lobes->tree(std::min(first + 1, m_lobes->info().columns - 1), 0);
    for (std::size_t i = 0; i < directions.size(); ++i)
      out[i] =
          point.n.dot(directions[i]) > 0
              ? blend(a, b, c - static_cast<float>(first),
                      wavelet::sphere_to_square(point.reflection.frame.to_local(directions[i])))
              : Rgb(Rgb::Zero());
  }

private:
  static Rgb blend(const wavelet::TreeView& a, const wavelet::TreeView& b, float share,
                   const Vec2& p) {
    const Rgb first = a.value(p.x(), p.y());
    return (first + (b.value(p.x(), p.y()) - first) * share).max(0.0F);
  }

  std::shared_ptr<const TreeTable> m_lobes;
};

} // namespace

ShadingPoint shading_point(const Vec3& n, const Vec3& wo) {
  return {n, wo, reflection_frame(n, wo)};
}

std::unique_ptr<Reflectance> lambert_reflectance(const Rgb& albedo) {
  return std::make_unique<Lambert>(albedo);
}

std::unique_ptr<Reflectance> measured_reflectance(brdf::MeasuredBrdf brdf) {
  return std::make_unique<Measured>(std::move(brdf));
}

std::unique_ptr<Reflectance> analytic_reflectance(const brdf::AnalyticBrdf& model) {
  return std::make_unique<Analytic>(model);
}

std::unique_ptr<Reflectance> tree_reflectance(std::shared_ptr<const TreeTable> lobes) {
  return std::make_unique<Trees>(std::move(lobes));
}

float theta_coordinate(const TreeTable& lobes, const ShadingPoint& point) {
  const float theta_r = arctangent(point.reflection.sin_theta_r, point.reflection.cos_theta_r);
  const float cells = static_cast<float>(lobes.info().columns);
  return std::clamp(theta_r * (2.0F / pi) * cells - 0.5F, 0.0F, cells - 1.0F);
}

} // namespace haarlight::renderer
