// probesynth: synthetic light probes as angular RGBE pictures.
#include <support/report.h>
#include <support/tool.h>

#include <probe/probe.h>
#include <probe/rgbe.h>
#include <probe/synth.h>

#include <wavelet/base/trigonometry.h>
#include <wavelet/file/provenance.h>

using namespace haarlight;

namespace {

struct Options {
  probe::SceneKind kind = probe::SceneKind::Studio;
  probe::SceneOptions scene;
  int size = 512;
  std::string output;
};

const std::vector<std::pair<std::string, probe::SceneKind>> scene_names = {
    {"studio", probe::SceneKind::Studio},
    {"sun-sky", probe::SceneKind::SunSky},
    {"spheres", probe::SceneKind::Spheres}};

void declare(tool::Tool& app, Options& o) {
  app.choice(o.kind, "--scene", scene_names,
             "Synthetic environment: studio = softboxes, sun-sky = sun and sky over ground, "
             "spheres = small bright lights in the dark");
  app.require("--scene");
  app.output(o.output, "OUT.hdr", "Light probe to write: Radiance RGBE, angular map");
  app.value(o.size, "--size", "Pixels along a side of the picture", 8, 8192);
  app.value(o.scene.seed, "--seed", "Random seed of studio and spheres");
  app.value(o.scene.turbidity, "--turbidity", "Turbidity of the sky; 2 = clear", 2, 10);
  app.value(o.scene.sun_elevation, "--sun-elevation",
            "Elevation of the sun, degrees above the horizon", 0, 90);
  app.value(o.scene.sun_azimuth, "--sun-azimuth",
            "Azimuth of the sun, degrees from forward (-z) to the right (+x)", -360, 360);
  app.offer_json();
}

std::string name_of(probe::SceneKind kind) {
  for (const auto& [name, each] : scene_names)
    if (each == kind)
      return name;
  return {};
}

/// The options that determine the picture, as header lines.
std::vector<std::string> comments(const Options& o) {
  std::vector<std::string> lines = {version_text() + " probesynth, angular map",
                                    "scene=" + name_of(o.kind)};
  if (o.kind != probe::SceneKind::SunSky) {
    lines.push_back("seed=" + std::to_string(o.scene.seed));
    return lines;
  }
  lines.push_back("turbidity=" + tool::short_text(o.scene.turbidity));
  lines.push_back("sun_elevation=" + tool::short_text(o.scene.sun_elevation));
  lines.push_back("sun_azimuth=" + tool::short_text(o.scene.sun_azimuth));
  return lines;
}

tool::Report describe(const Image& image, const std::string& path) {
  const probe::Probe light(image, probe::Mapping::Angular);
  float largest = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      largest = std::max(largest, luminance(image.at(x, y)));
  tool::Report report;
  report.add("size", image.width, "pixels")
      .add("mean_luminance", luminance(light.integral()) / (4 * pi))
      .add("largest_luminance", largest)
      .add("output", path);
  return report;
}

int draw(const tool::Tool& app, const Options& options) {
  const auto scene = probe::make_scene(options.kind, options.scene);
  const Image image = probe::draw_angular(*scene, options.size);
  probe::write_rgbe(options.output, image, comments(options));
  app.print(describe(image, options.output));
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv,
                           tool::command("probesynth",
                                         "Synthesises a light probe: radiance by direction, as an "
                                         "angular map (right +x, up +y, forward -z at the centre).",
                                         declare, draw));
}
