#pragma once
// BRDFs and probes with their trees, and the scenes that pairs of them make.

#include <bench/cache.h>
#include <bench/plan.h>

#include <renderer/scene/scene.h>

#include <map>
#include <string>
#include <vector>

namespace haarlight::bench {

/// A BRDF or a probe.
struct Entry {
  Subject subject;
  CachedTrees trees;
  std::map<std::string, CachedTrees> tables; ///< by the suffix of their recipe
};

struct Collection {
  std::vector<Entry> brdfs;
  std::vector<Entry> probes;
};

/// Reads every source once, so that a broken one is told of before any long work.
/// @throws Error(Input) as their readers
Collection open_subjects(const Plan& plan);

/// Makes or finds all trees that the plan's samplers use. @throws Error(Output)
void make_trees(const Plan& plan, const Cache& cache, Collection& collection);

/// A scene whose light and first material are a pair, and what the trees it names took to make.
struct PairScene {
  renderer::SceneDescription description;
  double precompute_seconds = 0;
};

/// @param sampler names tables only where this sampler needs them
PairScene pair_scene(renderer::SceneDescription scene, const Entry& brdf, const Entry& probe,
                     renderer::SamplerKind sampler);

} // namespace haarlight::bench
