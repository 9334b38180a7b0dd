#include <bench/cache.h>

#include <html/text_file.h>
#include <support/progress.h>
#include <support/words.h>

#include <brdf/brdf_maps.h>
#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <wavelet/file/input_file.h>
#include <wavelet/transform/compress.h>

#include <nlohmann/json.hpp>

#include <bit>
#include <ctime>
#include <fstream>
#include <optional>

namespace haarlight::bench {
namespace {

using nlohmann::ordered_json;

bool power_of_two(int size) { return std::has_single_bit(static_cast<unsigned>(size)); }

double process_cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// What the trees took to make, if the note beside them says they are those of `key`.
std::optional<double> noted_seconds(const std::string& path, const std::string& key) {
  std::ifstream file(path + ".json");
  const ordered_json note = ordered_json::parse(file, nullptr, false);
  try {
    if (note.is_object() && note.at("key") == key && note.at("hash") == file_hash(path))
      return note.at("cpu_seconds").get<double>();
  } catch (const std::exception&) {
    return std::nullopt; // trees are missing, or the note is none of ours: both are made anew
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

} // namespace haarlight::bench
