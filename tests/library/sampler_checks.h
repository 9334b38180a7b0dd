#pragma once
// The checks that every sampler has to pass.

#include "chi_square.h"
#include "sampler_fixture.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <span>

namespace haarlight::renderer {

inline constexpr std::size_t sample_count = 4096;

/// The standard error that sample_count independent samples have in truth: what the samples say of
/// it themselves is far too small where a sampler rarely finds the integrand.
inline double true_error(const LoadedScene& scene, const Sampler& sampler,
                         const ShadingPoint& point, const probe::Probe& probe, double truth) {
  double square = 0;
  for_each_point(probe, 4, [&](const Vec3& w, double omega) {
    const double value = integrand(scene, point, w);
    if (value > 0)
      square += omega * value * value / static_cast<double>(sampler.pdf(w, sample_count));
  });
  return std::sqrt(std::max(0.0, square - truth * truth) / sample_count);
}

struct Estimate {
  double mean = 0;
  double error = 0; ///< as the samples themselves have it
};

inline Estimate estimate_with(const LoadedScene& scene, Sampler& sampler, const ShadingPoint& point,
                              std::uint32_t key) {
  std::vector<DirectionSample> samples(sample_count);
  sampler.sample({Points::Random, key, 0}, samples);
  double sum = 0;
  double square = 0;
  for (const DirectionSample& s : samples)
    if (s.pdf > 0) {
      const double value = integrand(scene, point, s.direction) / static_cast<double>(s.pdf);
      sum += value / sample_count;
      square += value * value / sample_count;
    }
  return {sum, std::sqrt(std::max(0.0, square - sum * sum) / sample_count)};
}

/// Whether one sampler's means agree with quadrature at all shading points. @param what for
/// messages
/// @param key distinguishes runs; advances by 6 @return how many are beyond three standard errors
inline int count_strays(const SceneDescription& description, SamplerKind kind,
                        const std::string& what, std::uint32_t key) {
  const probe::Probe source = probe_of(description);
  const LoadedScene scene(description, {}, kind, false);
  const auto factory = make_sampler_factory(kind, scene, {});
  const auto sampler = factory->make(16);
  int strays = 0;
  for (const ShadingPoint& point : shading_points()) {
    sampler->prepare(point, scene.materials()[0]);
    const double truth = quadrature(scene, point, source);
    const auto [mean, own_error] = estimate_with(scene, *sampler, point, key++);
    // The grid misses slivers of the probe's pixels, the samples what they did not find.
    const double error = std::max(own_error, true_error(scene, *sampler, point, source, truth));
    INFO(what << " with " << sampler_name(kind) << ": " << mean << " ± " << error << ", not "
              << truth);
    // Quadrature itself is good to about 0.1 %.
    const double sigmas = (std::abs(mean - truth) - 1e-3 * truth) / error;
    CHECK(sigmas < 4.5);
    strays += sigmas > 3 ? 1 : 0;
  }
  return strays;
}

/// Whether samplers' means agree with quadrature, in 24 cases each, and none too far too often.
inline void check_unbiased(std::span<const SamplerKind> kinds, int allowed_beyond_three) {
  int beyond_three = 0;
  std::uint32_t key = 1;
  for (const std::string material : {"rough", "glossy"})
    for (const std::string probe : {"studio", "spheres"})
      for (const SamplerKind kind : kinds) {
        beyond_three +=
            count_strays(fixture().scene(material, probe), kind, material + " under " + probe, key);
        key += 6;
      }
  CHECK(beyond_three <= allowed_beyond_three);
}

/// Whether a sampler draws what its pdf() says, and says the same of each sample.
inline void check_density(const SceneDescription& description, SamplerKind kind,
                          const std::string& what, std::uint32_t key) {
  const LoadedScene scene(description, {}, kind, false);
  const auto factory = make_sampler_factory(kind, scene, {});
  const auto sampler = factory->make(16);
  sampler->prepare(shading_points()[3], scene.materials()[0]);
  constexpr int count = 100000;
  std::vector<DirectionSample> samples(count);
  sampler->sample({Points::Random, key, 0}, samples);
  float worst = 0;
  for (std::size_t i = 0; i < count; i += 97)
    worst =
        std::max(worst, std::abs(sampler->pdf(samples[i].direction, count) / samples[i].pdf - 1));
  const auto result = chi_square(
      count, 32, 16,
      [&](int i) {
        return wavelet::sphere_to_square(samples[static_cast<std::size_t>(i)].direction);
      },
      [&](Vec2 p) {
        return static_cast<double>(sampler->pdf(wavelet::square_to_sphere(p), count) *
                                   wavelet::sphere_area);
      });
  INFO(what << " with " << sampler_name(kind) << ", worst pdf ratio " << worst);
  CHECK(result.pdf_sum == Approx(1).margin(0.02));
  CHECK(result.statistic < result.limit);
}

inline void check_densities(std::span<const SamplerKind> kinds) {
  std::uint32_t key = 1000;
  for (const std::string material : {"rough", "glossy"})
    for (const SamplerKind kind : kinds)
      check_density(fixture().scene(material, "studio"), kind, material, key++);
}

} // namespace haarlight::renderer
