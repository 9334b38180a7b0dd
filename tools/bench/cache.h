#pragma once
// The trees of BRDFs and probes, made once and kept in a folder.

#include <support/tool.h>

#include <renderer/samplers/sampler_kind.h>
#include <wavelet/transform/threshold.h>
#include <wavelet/tree/map_set.h>

#include <functional>
#include <memory>
#include <string>

namespace haarlight::bench {

/// How maps are made, in the words of brdf2maps and probe2maps.
struct CacheOptions {
  int brdf_size = 0;
  int theta = 64;
  int probe_size = 0;
  int table_size = 128;
  int rolls = 128;
  int orientations = 64;
};

/// @throws UsageError for what cannot be made
void check(const CacheOptions& options);

/// A measured BRDF or a probe.
struct Subject {
  std::string path;
  std::string name; ///< of the file, without directory and extension
  std::string hash; ///< of the file's bytes
};

/// What a sampler wants of its tables.
struct TableRecipe {
  std::string suffix; ///< of their names in the folder
  wavelet::Criterion criterion = wavelet::Criterion::Variance;
  double tolerance = 0.0005; ///< see Criterion
};

/// Of a sampler with NeedsTables: those that it was published with where that is known, else those
/// that brdf2maps --roll and probe2maps --orientations make.
TableRecipe table_recipe(const renderer::SamplerTraits& sampler);

struct CachedTrees {
  std::string path;   ///< of the .haar file
  double seconds = 0; ///< CPU time that making it took, whenever that was
};

/// Beside each .haar lies a note of what it was made from: it is made anew if source, options or
/// version are others, or if its bytes are not those noted.
class Cache {
public:
  /// @param folder is there
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

} // namespace haarlight::bench
