#include <render/film_output.h>

#include <support/report.h>
#include <support/tool.h>

#include <image/image_exr.h>
#include <image/png.h>

#include <wavelet/file/input_file.h>

#include <algorithm>
#include <charconv>
#include <vector>

namespace haarlight::tool {

using namespace renderer;

namespace {

/// Every file a scene names, once, in its order.
std::vector<std::string> sources_of(const SceneDescription& scene) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end())
      files.push_back(file);
  };
  for (const std::string& file : {scene.light.probe, scene.light.haar, scene.light.table})
    add(file);
  for (const MaterialDescription& material : scene.materials)
    for (const std::string& file : {material.brdf, material.haar, material.table})
      add(file);
  return files;
}

/// The options of all samplers.
void set_sampling(const SamplerOptions& sampling, Provenance& result) {
  result.set("product variance", short_text(static_cast<double>(sampling.product.variance_bound)));
  result.set("product drift",
             short_text(static_cast<double>(sampling.product.reuse_variance_bound)));
  result.set("product leaves", std::to_string(sampling.product.max_leaves));
  result.set("candidates", std::to_string(sampling.candidates));
  result.set("regions", std::to_string(sampling.regions));
  result.set("pps samples", std::to_string(sampling.pps_samples));
}

Provenance provenance_of(const SceneDescription& scene, const RenderOptions& options, int spp) {
  Provenance result;
  result.set("version", version_text());
  result.set("scene", base_name(scene.path) + " " + scene.hash);
  set_sources(scene, result);
  result.set("sampler", sampler_name(options.sampler));
  result.set("estimator", estimator_name(options.estimator));
  result.set("points", options.points == Points::Sobol ? "sobol" : "random");
  result.set("spp", std::to_string(spp));
  result.set("seed", std::to_string(options.seed));
  set_sampling(options.sampling, result);
  return result;
}

double nanoseconds_per(double seconds, std::uint64_t count) {
  return count > 0 ? 1e9 * seconds / static_cast<double>(count) : 0;
}

} // namespace

void set_sources(const SceneDescription& scene, Provenance& provenance) {
  int number = 0;
  for (const std::string& file : sources_of(scene))
    provenance.set("source " + std::to_string(++number), base_name(file) + " " + file_hash(file));
}

void check_sources(const Tool& tool, const SceneDescription& scene) {
  for (const std::string& file : sources_of(scene))
    tool.reads("a source of the scene", file);
}

void write_film_exr(const std::string& path, const RenderResult& result,
                    const SceneDescription& scene, const RenderOptions& options,
                    const std::vector<std::pair<std::string, std::string>>& integrator) {
  const Film& film = result.film;
  image::ExrImage exr;
  exr.width = film.width;
  exr.height = film.height;
  exr.channels = {{"R", film.rgb.data(), 3},          {"G", film.rgb.data() + 1, 3},
                  {"B", film.rgb.data() + 2, 3},      {"N.X", film.normal.data(), 3},
                  {"N.Y", film.normal.data() + 1, 3}, {"N.Z", film.normal.data() + 2, 3},
                  {"pdf_sum", film.pdf_sum.data()},   {"variance", film.variance.data()},
                  {"samples", film.samples.data()}};
  const int spp = result.statistics.spp;
  Provenance provenance = provenance_of(scene, options, spp);
  for (const auto& [key, value] : integrator)
    provenance.set(key, value);
  exr.texts = {{"haarlight:provenance", provenance.text()}};
  image::write_exr(path, exr);
}

void write_film_png(const std::string& path, const Film& film, double exposure) {
  Image picture(film.width, film.height);
  picture.rgb = film.rgb;
  image::write_png(path, picture, {exposure, image::ToneMap::Filmic});
}

Report describe(const RenderResult& result) {
  const RenderStatistics& s = result.statistics;
  const double seconds = std::max(s.seconds, 1e-9);
  Report report;
  report.add("width", result.film.width, "px")
      .add("height", result.film.height, "px")
      .add("samples_per_pixel", s.spp)
      .add("samples", s.samples)
      .add("seconds", s.seconds, "s")
      .add("samples_per_second", static_cast<double>(s.samples) / seconds)
      .add("prepare_ns_per_point", nanoseconds_per(s.prepare_seconds, s.points), "ns")
      .add("thread_ns_per_sample", nanoseconds_per(s.thread_seconds, s.samples), "ns")
      .add("leaves_per_product", s.mean_leaves)
      .add("relative_variance_per_sample", s.relative_variance_per_sample);
  return report;
}

void set_film_size(const std::string& text, SceneDescription& scene) {
  long long width = 0;
  long long height = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  const bool crossed = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  const auto second = std::from_chars(crossed ? first.ptr + 1 : end, end, height);
  if (second.ec != std::errc() || second.ptr != end)
    throw UsageError("--size: '" + text + "' is not of the form WIDTHxHEIGHT, as in 640x480");
  const std::string problem = validate_film_size(width, height);
  if (!problem.empty())
    throw UsageError("--size: " + problem);
  scene.width = static_cast<int>(width);
  scene.height = static_cast<int>(height);
}

} // namespace haarlight::tool
