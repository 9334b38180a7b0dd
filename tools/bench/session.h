#pragma once
// One sampler in one scene, loaded, and its runs.

#include <bench/pairs.h>
#include <bench/plan.h>
#include <bench/statistics.h>

#include <renderer/film/render.h>
#include <wavelet/base/image.h>

#include <memory>
#include <vector>

namespace haarlight::bench {

/// Runs alike but for their seeds.
struct Runs {
  int spp = 0;
  std::vector<Pixels> luminances;  ///< of the pixels that hit an object
  Pixels variances;                ///< of those, of one run's mean: estimated within the runs
  double seconds = 0;              ///< of a film: the least of the runs
  Image first;                     ///< of the first seed
  Image mean;                      ///< of all
  std::vector<std::size_t> pixels; ///< indices in the film of those that hit an object
};

std::vector<double> seconds_of(const std::vector<Runs>& all);

class Session {
public:
  /// @param options with sampler and estimator
  Session(const renderer::SceneDescription& description, const renderer::RenderOptions& options);

  /// @param seed,count seeds seed, seed + 1, …
  Runs run(renderer::Points points, int spp, std::uint32_t seed, int count) const;

  /// What a film costs, by the runs there are at rising spp; if they are of one spp only, others
  /// are rendered.
  CostModel cost(renderer::Points points, std::uint32_t seed, int count,
                 const std::vector<Runs>& all) const;

  /// Runs of about the most samples that fit a budget, seconds of a film. What set-up costs may go
  /// by their number, so each run tells the model of the next.
  Runs run_within(double budget, renderer::Points points, std::uint32_t seed, int count,
                  CostModel& cost) const;

  /// Once for a scene: what comes after its files are read.
  double setup_seconds() const { return m_setup_seconds; }

  const renderer::LoadedScene& scene() const { return *m_scene; }

private:
  renderer::RenderOptions m_options;
  std::unique_ptr<renderer::LoadedScene> m_scene;
  std::unique_ptr<renderer::RenderFactories> m_factories;
  double m_setup_seconds = 0;
};

} // namespace haarlight::bench
