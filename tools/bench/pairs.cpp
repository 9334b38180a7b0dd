#include <bench/pairs.h>

#include <brdf/merl_file.h>
#include <probe/read_probe.h>
#include <wavelet/file/input_file.h>

namespace haarlight::bench {

using namespace renderer;

namespace {

Entry entry_of(const std::string& path) {
  return {.subject = {.path = path, .name = stem_of(path), .hash = file_hash(path)},
          .trees = {},
          .tables = {}};
}

} // namespace

Collection open_subjects(const Plan& plan) {
  Collection result;
  for (const std::string& path : plan.brdfs) {
    brdf::read_merl(path);
    result.brdfs.push_back(entry_of(path));
  }
  for (const std::string& path : plan.probes) {
    probe::read_probe(path);
    result.probes.push_back(entry_of(path));
  }
  return result;
}

void make_trees(const Plan& plan, const Cache& cache, Collection& collection) {
  for (Entry& entry : collection.brdfs)
    entry.trees = cache.brdf(entry.subject);
  for (Entry& entry : collection.probes)
    entry.trees = cache.probe(entry.subject);
  for (const SamplerKind kind : plan.samplers) {
    if (!needs(kind, NeedsTables))
      continue;
    const TableRecipe recipe = table_recipe(traits(kind));
    for (Entry& entry : collection.brdfs)
      if (!entry.tables.contains(recipe.suffix))
        entry.tables[recipe.suffix] = cache.brdf_table(entry.subject, recipe);
    for (Entry& entry : collection.probes)
      if (!entry.tables.contains(recipe.suffix))
        entry.tables[recipe.suffix] = cache.probe_table(entry.subject, recipe);
  }
}

PairScene pair_scene(SceneDescription scene, const Entry& brdf, const Entry& probe,
                     SamplerKind sampler) {
  PairScene result;
  LightDescription& light = scene.light;
  light.probe = probe.subject.path;
  light.haar = probe.trees.path;
  light.table.clear();
  light.mapping = "auto";
  MaterialDescription material;
  material.name = scene.materials.front().name;
  material.brdf = brdf.subject.path;
  material.haar = brdf.trees.path;
  if (needs(sampler, NeedsLightTree))
    result.precompute_seconds += probe.trees.seconds;
  if (needs(sampler, NeedsMaterialTrees) || needs(sampler, NeedsLobes))
    result.precompute_seconds += brdf.trees.seconds;
  if (needs(sampler, NeedsTables)) {
    const std::string suffix = table_recipe(traits(sampler)).suffix;
    light.table = probe.tables.at(suffix).path;
    material.table = brdf.tables.at(suffix).path;
    result.precompute_seconds += probe.tables.at(suffix).seconds + brdf.tables.at(suffix).seconds;
  }
  scene.materials.front() = material;
  result.description = std::move(scene);
  return result;
}

} // namespace haarlight::bench
