#pragma once
// BRDFs and probes with their trees, which are made once and cached in a folder, and the scenes
// that are rendered with them.

#include <support/tool.h>

#include <renderer/samplers/sampler_kind.h>
#include <renderer/scene/scene.h>
#include <wavelet/transform/threshold.h>
#include <wavelet/tree/map_set.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace haarlight::bench {

struct Plan;

/// How maps are made; the options of brdf2maps and probe2maps.
struct CacheOptions {
  int brdf_size = 0;
  int theta = 64;
  int probe_size = 0;
  int table_size = 128;
  int rolls = 128;
  int orientations = 64;
};

/// @throws UsageError for invalid sizes
void check(const CacheOptions& options);

/// A measured BRDF or a probe.
struct Subject {
  std::string path;
  std::string name; ///< of the file, without directory and extension
  std::string hash; ///< of the file's bytes
};

/// Thresholding of the tables of a sampler.
struct TableRecipe {
  std::string suffix; ///< of their file names
  wavelet::Criterion criterion = wavelet::Criterion::Variance;
  double tolerance = 0.0005; ///< see Criterion
};

/// For a sampler with NeedsTables: as published if that is known, else the defaults of brdf2maps
/// --roll and probe2maps --orientations.
TableRecipe table_recipe(const renderer::SamplerTraits& sampler);

struct CachedTrees {
  std::string path;   ///< of the .haar file
  double seconds = 0; ///< CPU time of making it, whenever it was made
};

/// A note beside each .haar records its source, options, version and hash. The file is made again
/// if any of them differs.
class Cache {
public:
  /// @param folder exists
  Cache(const tool::Tool& app, std::string folder, const CacheOptions& options)
      : m_app(app), m_folder(std::move(folder)), m_options(options) {}

  /// The θ_r-only set; the one world-frame map.
  CachedTrees brdf(const Subject& subject) const;
  CachedTrees probe(const Subject& subject) const;

  /// The set with rolls; the table of rotated maps.
  CachedTrees brdf_table(const Subject& subject, const TableRecipe& recipe) const;
  CachedTrees probe_table(const Subject& subject, const TableRecipe& recipe) const;

private:
  using MakeSource = std::function<std::unique_ptr<wavelet::MapSource>()>;

  CachedTrees trees(const std::string& name, const std::string& key, const TableRecipe* recipe,
                    const MakeSource& make) const;

  const tool::Tool& m_app;
  std::string m_folder;
  CacheOptions m_options;
};

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

/// Reads every source once, so that a malformed one is reported before any long work.
/// @throws Error(Input)
Collection open_subjects(const Plan& plan);

/// Makes all trees that the plan's samplers use, or finds them in the cache. @throws Error(Output)
void make_trees(const Plan& plan, const Cache& cache, Collection& collection);

/// A scene whose light and first material are a pair, and the CPU time of making its trees.
struct PairScene {
  renderer::SceneDescription description;
  double precompute_seconds = 0;
};

/// @param sampler the scene names tables only if this sampler needs them
PairScene pair_scene(renderer::SceneDescription scene, const Entry& brdf, const Entry& probe,
                     renderer::SamplerKind sampler);

/// `sphere`: orthographic, one unoccluded sphere that fills the film. `spheres`: perspective, three
/// spheres that shadow a plane and each other, all of one material; every pixel hits an object.
/// Neither shows a background. Any other word is a scene file.
/// @throws Error(Input) as load_scene(), and for a file without materials
renderer::SceneDescription scene_of(const std::string& word);

/// The name of the scene in the results.
std::string scene_name(const std::string& word);

} // namespace haarlight::bench
