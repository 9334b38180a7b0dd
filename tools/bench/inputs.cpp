#include <bench/inputs.h>

#include <bench/plan.h>
#include <html/page.h>
#include <support/progress.h>

#include <brdf/brdf_maps.h>
#include <brdf/merl_file.h>
#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>
#include <wavelet/transform/compress.h>

#include <nlohmann/json.hpp>

#include <bit>
#include <ctime>
#include <fstream>
#include <optional>

namespace haarlight::bench {

using namespace renderer;
using nlohmann::ordered_json;

namespace {

bool power_of_two(int size) { return std::has_single_bit(static_cast<unsigned>(size)); }

double process_cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// The CPU time of making the trees, if the note beside them has this key and their hash.
std::optional<double> noted_seconds(const std::string& path, const std::string& key) {
  std::ifstream file(path + ".json");
  const ordered_json note = ordered_json::parse(file, nullptr, false);
  try {
    if (note.is_object() && note.at("key") == key && note.at("hash") == file_hash(path))
      return note.at("cpu_seconds").get<double>();
  } catch (const std::exception&) {
    return std::nullopt; // no trees, or another note: both are made again
  }
  return std::nullopt;
}

void write_note(const std::string& path, const std::string& key, double seconds) {
  const ordered_json note = {{"key", key}, {"hash", file_hash(path)}, {"cpu_seconds", seconds}};
  html::write_text(path + ".json", note.dump(2) + '\n');
}

std::string key_of(const Subject& subject, int size, int across, int down) {
  return version_text() + ' ' + subject.hash + ' ' + std::to_string(size) + ' ' +
         std::to_string(across) + ' ' + std::to_string(down);
}

std::unique_ptr<wavelet::MapSource> brdf_maps(const Subject& subject,
                                              const brdf::BrdfMapOptions& options) {
  return std::make_unique<brdf::BrdfMaps>(brdf::MeasuredBrdf(subject.path), options);
}

std::unique_ptr<wavelet::MapSource> probe_maps(const Subject& subject,
                                               const probe::MapOptions& options) {
  const probe::LoadedProbe loaded = probe::read_probe(subject.path);
  return std::make_unique<probe::ProbeMaps>(loaded.probe, options, loaded.source);
}

Entry entry_of(const std::string& path) {
  return {.subject = {.path = path, .name = stem_of(path), .hash = file_hash(path)},
          .trees = {},
          .tables = {}};
}

bool built_in(const std::string& word) { return word == "sphere" || word == "spheres"; }

void add(const Shape& shape, SceneDescription& scene) {
  ObjectDescription object;
  object.shape = shape;
  scene.objects.push_back(object);
}

SceneDescription one_sphere() {
  SceneDescription scene;
  scene.camera.projection = CameraProjection::Orthographic;
  scene.camera.from = Vec3(0, 0, 6);
  scene.camera.height = 2;
  add(Sphere(), scene);
  return scene;
}

SceneDescription three_spheres() {
  SceneDescription scene;
  scene.camera.from = Vec3(0, 4, 6);
  scene.camera.to = Vec3(0, -0.3F, 0);
  scene.camera.fov = 32;
  add(Plane{Vec3(0, -1, 0), Vec3::UnitY()}, scene);
  add(Sphere{Vec3(0, 0, -0.6F), 1}, scene);
  add(Sphere{Vec3(-1.2F, -0.4F, 0.7F), 0.6F}, scene);
  add(Sphere{Vec3(1.1F, -0.5F, 0.8F), 0.5F}, scene);
  return scene;
}

} // namespace

void check(const CacheOptions& options) {
  for (const int size : {options.brdf_size, options.probe_size, options.table_size})
    if (size != 0 && (!power_of_two(size) || size < 4))
      throw tool::UsageError("--brdf-size, --probe-size and --table-size must be powers of two "
                             "from 4");
}

TableRecipe table_recipe(const renderer::SamplerTraits& sampler) {
  if (sampler.name == std::string("wais")) // Clarberg et al. 2005 keep the largest coefficients
    return {.suffix = "-table-l2", .criterion = wavelet::Criterion::L2, .tolerance = 0.03};
  return {.suffix = "-table"};
}

CachedTrees Cache::brdf(const Subject& subject) const {
  brdf::BrdfMapOptions options;
  options.size = m_options.brdf_size;
  options.theta = m_options.theta;
  return trees("brdf-" + subject.name, key_of(subject, options.size, options.theta, 1), nullptr,
               [&] { return brdf_maps(subject, options); });
}

CachedTrees Cache::probe(const Subject& subject) const {
  const probe::MapOptions options{.size = m_options.probe_size};
  return trees("probe-" + subject.name, key_of(subject, options.size, 1, 1), nullptr,
               [&] { return probe_maps(subject, options); });
}

CachedTrees Cache::brdf_table(const Subject& subject, const TableRecipe& recipe) const {
  brdf::BrdfMapOptions options;
  options.size = m_options.table_size;
  options.theta = m_options.theta;
  options.roll = m_options.rolls;
  return trees("brdf-" + subject.name + recipe.suffix,
               key_of(subject, options.size, options.theta, options.roll), &recipe,
               [&] { return brdf_maps(subject, options); });
}

CachedTrees Cache::probe_table(const Subject& subject, const TableRecipe& recipe) const {
  const probe::MapOptions options{.size = m_options.table_size,
                                  .orientations = m_options.orientations};
  return trees("probe-" + subject.name + recipe.suffix,
               key_of(subject, options.size, options.orientations, options.orientations), &recipe,
               [&] { return probe_maps(subject, options); });
}

CachedTrees Cache::trees(const std::string& name, const std::string& key, const TableRecipe* recipe,
                         const MakeSource& make) const {
  const std::string path = m_folder + "/" + name + ".haar";
  std::string full_key = key;
  if (recipe != nullptr)
    full_key.append(" ")
        .append(wavelet::criterion_name(recipe->criterion))
        .append(" ")
        .append(tool::exact_text(recipe->tolerance));
  if (const auto seconds = noted_seconds(path, full_key))
    return {path, *seconds};
  const double start = process_cpu_seconds();
  const std::unique_ptr<wavelet::MapSource> source = make();
  wavelet::CompressOptions options;
  if (recipe != nullptr)
    options.threshold = {recipe->criterion, recipe->tolerance, {}};
  else
    options.threshold.tolerance =
        wavelet::default_tolerance(source->info(), options.threshold.criterion);
  OutputFile file(path);
  tool::ProgressBar bar(m_app, "making " + name);
  wavelet::compress_set(*source, options, file, bar.callback());
  file.commit();
  const double seconds = process_cpu_seconds() - start;
  write_note(path, full_key, seconds);
  m_app.detail(path + ": made in " + tool::short_text(seconds) + " CPU s");
  return {path, seconds};
}

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

std::string scene_name(const std::string& word) { return built_in(word) ? word : stem_of(word); }

SceneDescription scene_of(const std::string& word) {
  if (!built_in(word)) {
    SceneDescription scene = load_scene(word);
    if (scene.materials.empty())
      throw_input_error(word, "has no material to replace by the BRDF");
    return scene;
  }
  SceneDescription scene = word == "sphere" ? one_sphere() : three_spheres();
  scene.path = word;
  scene.light.background = false;
  scene.materials.resize(1);
  scene.materials.front().name = "measured";
  return scene;
}

} // namespace haarlight::bench
