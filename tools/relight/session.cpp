#include <relight/session.h>

#include <render/film_output.h>
#include <support/arguments.h>
#include <support/report.h>

#include <image/image_exr.h>

#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

namespace haarlight::tool {

using namespace renderer;

namespace {

std::string scene_path(const ChangeOptions& options, const Transfer& transfer) {
  if (!options.scene.empty())
    return options.scene;
  const std::size_t slash = options.transfer.rfind('/');
  const std::string folder =
      slash == std::string::npos ? "" : options.transfer.substr(0, slash + 1);
  return folder + transfer.scene_name();
}

/// Refuses an option that does not fit the varying factor.
void require_fit(const Tool& app, const Transfer& transfer, const char* option, bool fits,
                 const char* wanted) {
  if (app.declares(option) && app.given(option) && !fits)
    throw UsageError(std::string(option) + ": " + transfer.path() + " was built with --vary " +
                     transfer.varying_text() + ", not " + wanted);
}

void check_fit(const Tool& app, const Transfer& transfer, Varying varying) {
  const bool light = varying == Varying::Light;
  const bool moves = varying == Varying::Object || varying == Varying::View;
  require_fit(app, transfer, "--probe", light, "light");
  require_fit(app, transfer, "--brdf", varying == Varying::Material, "material:NAME");
  for (const char* option : {"--rotate", "--rotate-from", "--rotate-to"})
    require_fit(app, transfer, option, light, "light");
  for (const char* option : {"--move", "--move-from", "--move-to"})
    require_fit(app, transfer, option, moves, "object:NAME or view");
}

/// Replaces files of the scene by those given.
void replace_sources(const ChangeOptions& options, const Variation& variation,
                     SceneDescription& scene) {
  if (!options.probe.empty()) {
    const bool trees = has_extension(options.probe, ".haar");
    scene.light.probe = trees ? "" : options.probe;
    scene.light.haar = trees ? options.probe : "";
    scene.light.table.clear();
    scene.light.mapping = "auto";
  }
  if (options.brdf.empty())
    return;
  MaterialDescription& material = scene.materials[static_cast<std::size_t>(variation.index)];
  const bool trees = has_extension(options.brdf, ".haar");
  const std::string name = material.name;
  material = MaterialDescription();
  material.name = name;
  (trees ? material.haar : material.brdf) = options.brdf;
}

std::string list_text(double x, double y, double z) {
  return short_text(x) + "," + short_text(y) + "," + short_text(z);
}

} // namespace

void declare_change(Tool& app, ChangeOptions& options) {
  app.input(options.transfer, "T.haar", "Transfer made by haarrelight build");
  app.optional_input(options.scene, "--scene", "SCENE.json",
                     "The scene of the transfer [the file of that name beside T.haar]");
  app.optional_input(
      options.probe, "--probe", "PROBE",
      "light: another light: a probe image, or a .haar with one world-frame map [the scene's]");
  app.optional_input(
      options.brdf, "--brdf", "BRDF",
      "material: another BRDF: a MERL file, or a .haar made from one without --roll [the scene's]");
  app.alias("--light", "--probe");
}

RelightInput::RelightInput(const Tool& app, const ChangeOptions& options)
    : m_transfer(options.transfer), m_scene(load_scene(scene_path(options, m_transfer))),
      m_variation(m_transfer.variation(m_scene)) {
  check_fit(app, m_transfer, m_variation.varying);
  replace_sources(options, m_variation, m_scene);
  app.reads("the scene", m_scene.path);
  check_sources(app, m_scene);
}

void write_relit_exr(const std::string& path, const Film& film, const Transfer& transfer,
                     const ChangeOptions& options, const Change& change) {
  Provenance p = transfer.provenance();
  p.set("transfer_hash", file_hash(options.transfer));
  for (const auto& [name, file] : {std::pair("light", options.probe), {"brdf", options.brdf}})
    if (!file.empty())
      p.set(name, base_name(file) + " " + file_hash(file));
  p.set("rotate", list_text(change.rotate[0], change.rotate[1], change.rotate[2]));
  const Eigen::Vector3d move = change.move.cast<double>();
  p.set("move", list_text(move[0], move[1], move[2]));
  image::ExrImage exr;
  exr.width = film.width;
  exr.height = film.height;
  exr.channels = {
      {"R", film.rgb.data(), 3}, {"G", film.rgb.data() + 1, 3}, {"B", film.rgb.data() + 2, 3}};
  exr.texts = {{"haarlight:provenance", p.text()}};
  image::write_exr(path, exr);
}

} // namespace haarlight::tool
