#include <view/comparison.h>

#include <support/arguments.h>

#include <image/image_exr.h>
#include <image/png.h>

#include <renderer/visibility/product_integral.h>
#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace haarlight::view {

using namespace renderer;

namespace {

Rgb reflected_radiance(const ViewScene& scene, const PunctualLight& light, const Hit& hit,
                       const Vec3& wo) {
  const Vec3 n = hit.normal.dot(wo) < 0 ? Vec3(-hit.normal) : hit.normal;
  const Vec3 to_light = light.is_point ? Vec3(light.place - hit.position) : light.place;
  const float distance = to_light.norm();
  const Vec3 direction = to_light / distance;
  const float reach = light.is_point ? distance : std::numeric_limits<float>::infinity();
  if (n.dot(direction) <= 0 || scene.shapes().occluded(leave(hit, direction, reach)))
    return Rgb::Zero();
  Rgb value;
  scene.reflectance_of(hit.object)
      .evaluate(shading_point(n, wo), std::span(&direction, 1), std::span(&value, 1));
  return value * light.irradiance.array() / (light.is_point ? distance * distance : 1.0F);
}

} // namespace

std::vector<float> cpu_punctual_frame(const ViewScene& scene, const ViewState& state) {
  const Camera camera(state.camera, state.width, state.height);
  const auto width = static_cast<std::size_t>(state.width);
  std::vector<float> rgb(3 * width * static_cast<std::size_t>(state.height));
  parallel_for(static_cast<std::size_t>(state.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const Ray ray =
          camera.generate_ray(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      Hit hit;
      if (!scene.shapes().intersect(ray, hit))
        continue;
      const Rgb colour = reflected_radiance(scene, state.punctual, hit, -ray.direction);
      std::copy(colour.begin(), colour.end(), rgb.begin() + 3 * (y * width + x));
    }
  });
  return rgb;
}

std::vector<float> cpu_environment_frame(const SceneDescription& scene, int width, int height) {
  SceneDescription trees = scene;
  trees.light.background = false;
  for (MaterialDescription& material : trees.materials)
    if (!material.haar.empty())
      material.brdf.clear();
  const LoadedScene loaded(trees, {}, SamplerKind::Light, false, product_integral_needs);
  return render_product_integral(loaded, {}, width, height).film.rgb;
}

std::vector<float> read_reference(const std::string& path, int width, int height) {
  Image reference = image::read_exr(path);
  if (reference.width != width || reference.height != height)
    throw_input_error(path, "has " + std::to_string(reference.width) + "x" +
                                std::to_string(reference.height) + " pixels; the frame has " +
                                std::to_string(width) + "x" + std::to_string(height));
  return std::move(reference.rgb);
}

double relative_rms(const std::vector<float>& frame, const std::vector<float>& reference) {
  double error = 0;
  double energy = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double expected = static_cast<double>(reference[i]);
    const double difference = static_cast<double>(frame[i]) - expected;
    error += difference * difference;
    energy += expected * expected;
  }
  return energy > 0 ? std::sqrt(error / energy) : std::sqrt(error);
}

double median_time(int repeat, const std::function<double()>& run) {
  std::vector<double> times(static_cast<std::size_t>(repeat));
  std::generate(times.begin(), times.end(), run);
  const auto middle = times.begin() + repeat / 2;
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

DrawnFrame FrameTest::write(const std::string& path, int width, int height, double exposure) const {
  draw(level);
  DrawnFrame frame = drawer.read();
  Image picture(width, height);
  picture.rgb = frame.rgb;
  if (tool::has_extension(path, ".png"))
    image::write_png(path, picture, {exposure, image::ToneMap::Filmic});
  else
    image::write_exr(path, picture);
  return frame;
}

void FrameTest::compare(const std::vector<float>& reference, int finest,
                        tool::Report& report) const {
  draw(level);
  report.add("relative_rms", relative_rms(drawer.read().rgb, reference));
  for (int coarse = 0; coarse <= finest; ++coarse) {
    const double ms = median_time(repeat, [&] { return draw(coarse); });
    const DrawnFrame frame = drawer.read();
    report.row("levels")
        .add("level", coarse)
        .add("relative_rms", relative_rms(frame.rgb, reference))
        .add("accesses", frame.accesses)
        .add("ms_per_frame", ms);
  }
}

} // namespace haarlight::view
