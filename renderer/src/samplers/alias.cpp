// The light alone: pixels of the probe by an alias table (Walker 1974, "New fast method for
// generating discrete random numbers with arbitrary frequency distributions"; built as by Vose
// 1991, "A linear algorithm for generating random numbers with a given distribution").

#include "samplers/sampler_factories.h"

#include <probe/probe.h>

namespace haarlight::renderer {
namespace {

using probe::LightDistribution;

/// Draws indices with given probabilities in constant time: each bucket has its own index and one
/// alias.
class AliasTable {
public:
  /// @param weights ≥ 0, not all 0
  explicit AliasTable(std::vector<double> weights) : m_buckets(weights.size()) {
    normalise(weights);
    std::vector<std::uint32_t> small;
    std::vector<std::uint32_t> large;
    for (std::size_t i = 0; i < weights.size(); ++i)
      (weights[i] < 1 ? small : large).push_back(static_cast<std::uint32_t>(i));
    while (!small.empty() && !large.empty()) {
      const std::uint32_t poor = small.back();
      const std::uint32_t rich = large.back();
      small.pop_back();
      m_buckets[poor] = {static_cast<float>(weights[poor]), rich};
      weights[rich] -= 1 - weights[poor];
      if (weights[rich] < 1) {
        large.pop_back();
        small.push_back(rich);
      }
    }
    // Remaining buckets are full up to rounding.
    for (const std::uint32_t index : large)
      m_buckets[index] = {1, index};
    for (const std::uint32_t index : small)
      m_buckets[index] = {1, index};
  }

  std::uint32_t operator()(const Vec2& u) const {
    // One coordinate has too few digits for a bucket of millions and a choice within it.
    const double place = (static_cast<double>(u.x()) + static_cast<double>(u.y()) * 0x1p-24) *
                         static_cast<double>(m_buckets.size());
    const auto index = static_cast<std::uint32_t>(place);
    const Bucket& bucket = m_buckets[index];
    return place - index < static_cast<double>(bucket.keep) ? index : bucket.other;
  }

private:
  struct Bucket {
    float keep = 0;
    std::uint32_t other = 0;
  };

  /// Scales the weights to mean 1.
  static void normalise(std::vector<double>& weights) {
    double sum = 0;
    for (const double weight : weights)
      sum += weight;
    for (double& weight : weights)
      weight *= static_cast<double>(weights.size()) / sum;
  }

  std::vector<Bucket> m_buckets;
};

/// The alias table of a light's pixels; shared by threads.
class PixelTable {
public:
  explicit PixelTable(std::shared_ptr<const LightDistribution> light)
      : m_light(std::move(light)), m_alias(probabilities(*m_light)) {}

  void sample(std::span<const Vec2> pixels, std::span<LightDistribution::PixelPoint> places) const {
    const auto width = static_cast<std::uint32_t>(m_light->width());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::uint32_t index = m_alias(pixels[i]);
      places[i].x = static_cast<int>(index % width);
      places[i].y = static_cast<int>(index / width);
    }
  }

  const LightDistribution& light() const { return *m_light; }

private:
  static std::vector<double> probabilities(const LightDistribution& light) {
    std::vector<double> result;
    result.reserve(static_cast<std::size_t>(light.width()) *
                   static_cast<std::size_t>(light.height()));
    for (int y = 0; y < light.height(); ++y)
      for (int x = 0; x < light.width(); ++x)
        result.push_back(light.probability(x, y));
    return result;
  }

  std::shared_ptr<const LightDistribution> m_light;
  AliasTable m_alias;
};

class AliasSampler : public Sampler {
public:
  explicit AliasSampler(std::shared_ptr<const PixelTable> table) : m_table(std::move(table)) {}

  void prepare(const ShadingPoint& /*point*/, const Material& /*material*/) override {}

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    m_places.resize(out.size());
    m_samples.resize(out.size());
    points.fill(0, m_points);
    m_table->sample(m_points, m_places);
    points.fill(3, m_points);
    for (std::size_t i = 0; i < out.size(); ++i)
      m_places[i].fraction = m_points[i];
    m_table->light().sample_in(m_places, m_samples);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {m_samples[i].direction, m_samples[i].pdf};
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_table->light().pdf(direction);
  }

private:
  std::shared_ptr<const PixelTable> m_table;
  std::vector<Vec2> m_points;
  std::vector<LightDistribution::PixelPoint> m_places;
  std::vector<probe::LightSample> m_samples;
};

/// The probe's distribution, or the tree's if there is no probe.
std::shared_ptr<const LightDistribution> distribution_of(const Light& light) {
  if (const LightDistribution* owned_by_light = light.distribution())
    return {std::shared_ptr<const void>(), owned_by_light};
  return std::make_shared<LightDistribution>(tree_as_probe(light));
}

} // namespace

std::unique_ptr<SamplerFactory> make_alias_factory(const LoadedScene& scene,
                                                   const SamplerOptions& /*options*/) {
  return simple_factory<AliasSampler>(
      std::make_shared<const PixelTable>(distribution_of(scene.light())));
}

} // namespace haarlight::renderer
