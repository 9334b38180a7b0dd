#include <renderer/material/material.h>
#include <renderer/material/tree_table.h>

#include <brdf/brdf_maps.h>
#include <brdf/tabulate.h>
#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haarlight::renderer {
namespace {

/// Maps of albedo/π · max(0, n·ω) in the reflection frame, like brdf::BrdfMaps of measured BRDFs.
class LambertMaps : public wavelet::MapSource {
public:
  /// @param albedo per channel, in [0, 1]
  /// @param size   pixels along a side, a power of two
  /// @param theta  cells of θ_r
  /// @param rolls  cells of φ over the full circle, all stored; 1 = φ is 0
  LambertMaps(const Rgb& albedo, int size, int theta, int rolls) : m_albedo(albedo) {
    m_info.kind = wavelet::SetKind::Brdf;
    m_info.size = size;
    m_info.columns = theta;
    m_info.rows = rolls;
    m_info.rolls = rolls;
    m_info.cosine = true;
    m_info.units = "sr^-1";
  }

  const wavelet::SetInfo& info() const override { return m_info; }

  wavelet::Map make(int column, int row) const override {
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
        map.set(x, y, m_albedo / pi * average_cosine(n, x, y, map.size));
    return map;
  }

private:
  /// Average of max(0, n·ω) over a pixel.
  static float average_cosine(const Vec3& n, int x, int y, int size) {
    constexpr int taps = 4; // along a pixel's side; the only edge is the horizon
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

  Rgb m_albedo;
  wavelet::SetInfo m_info;
};

/// A model without highlight, whose sampling routine is the cosine's.
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
    return std::make_unique<LambertMaps>(m_albedo, 64, 64, 1);
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

/// Pixels along the side of a model's maps; fewer for wide lobes.
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

  /// Tabulated first, so that the maps miss no narrow lobe.
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
  static Rgb blend(const wavelet::TreeView& a, const wavelet::TreeView& b, float fraction,
                   const Vec2& p) {
    const Rgb first = a.value(p.x(), p.y());
    return (first + (b.value(p.x(), p.y()) - first) * fraction).max(0.0F);
  }

  std::shared_ptr<const TreeTable> m_lobes;
};

void require_cosine(const std::string& path, const TreeTable& table) {
  if (!table.info().cosine)
    throw_input_error(path,
                      "was made with --no-cosine; rendering needs a set that includes the cosine");
}

std::shared_ptr<const TreeTable> load_lobes(const std::string& path) {
  auto lobes = std::make_shared<TreeTable>(path, wavelet::SetKind::Brdf);
  require_cosine(path, *lobes);
  if (lobes->info().rolls != 1)
    throw_input_error(path, "holds a set with rolls, which belongs under the key \"table\"; "
                            "\"haar\" needs a set made with --roll 1");
  return lobes;
}

std::unique_ptr<Reflectance>
make_source_reflectance(const MaterialDescription& description, brdf::Lookup lookup,
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
  throw_input_error(description.table, "is the only file of material \"" + description.name +
                                           "\"; it needs \"brdf\" or \"haar\", too");
}

} // namespace

using wavelet::SetKind;

TreeTable::TreeTable(const std::string& path, SetKind kind, wavelet::Check check)
    : m_file(std::make_unique<wavelet::TreeSet>(path, check)), m_info(m_file->info()) {
  if (m_info.kind != kind)
    throw_input_error(path, kind == SetKind::Brdf
                                ? "is not a BRDF set; a .haar of brdf2maps is needed"
                                : "is not a light set; a .haar of probe2maps is needed");
}

TreeTable::TreeTable(const wavelet::MapSource& source) : m_info(source.info()) {
  m_owned.resize(static_cast<std::size_t>(m_info.map_count()));
  wavelet::CompressOptions options;
  options.threshold.tolerance = default_tolerance(m_info, options.threshold.criterion);
  parallel_for(m_owned.size(), [&](std::size_t i) {
    const int index = static_cast<int>(i);
    wavelet::CompressReport report;
    m_owned[i] =
        compress_map(source.make(index % m_info.columns, index / m_info.columns), options, report);
  });
  for (const wavelet::Tree& tree : m_owned)
    m_views.push_back(tree.view());
}

std::vector<wavelet::TreeView> TreeTable::trees() const {
  std::vector<wavelet::TreeView> all;
  all.reserve(static_cast<std::size_t>(m_info.map_count()));
  for (int row = 0; row < m_info.rows; ++row)
    for (int column = 0; column < m_info.columns; ++column)
      all.push_back(tree(column, row));
  return all;
}

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

Material::Material(const MaterialDescription& description, brdf::Lookup lookup)
    : m_name(description.name), m_emission(description.emission) {
  if (!description.haar.empty())
    m_lobes = load_lobes(description.haar);
  if (!description.table.empty()) {
    m_rolls.emplace(description.table, wavelet::SetKind::Brdf, wavelet::Check::WhenUsed);
    require_cosine(description.table, *m_rolls);
  }
  m_source_reflectance = make_source_reflectance(description, lookup, m_lobes);
}

void Material::require_trees() {
  if (has_trees())
    return;
  if (!m_lobes)
    m_lobes = std::make_shared<TreeTable>(*m_source_reflectance->maps());
  m_pyramid.emplace(m_lobes->trees());
}

void Material::require_lobe() {
  if (model() == nullptr)
    require_trees();
}

void Material::require_roll_table() {
  if (m_rolls)
    return;
  if (const auto maps = m_source_reflectance->roll_maps())
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
