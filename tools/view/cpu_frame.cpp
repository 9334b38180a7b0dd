#include <view/cpu_frame.h>

#include <renderer/visibility/product_integral.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <cmath>

namespace haarlight::view {

using namespace renderer;

namespace {

Rgb shade(const ViewScene& scene, const Lamp& lamp, const Hit& hit, const Vec3& wo) {
  const Vec3 n = hit.normal.dot(wo) < 0 ? Vec3(-hit.normal) : hit.normal;
  const Vec3 towards = lamp.at_point ? Vec3(lamp.place - hit.position) : lamp.place;
  const float distance = towards.norm();
  const Vec3 direction = towards / distance;
  const float reach = lamp.at_point ? distance : std::numeric_limits<float>::infinity();
  if (n.dot(direction) <= 0 || scene.shapes().occluded(leave(hit, direction, reach)))
    return Rgb::Zero();
  Rgb value;
  scene.reflectance_of(hit.object)
      .evaluate(shading_point(n, wo), std::span(&direction, 1), std::span(&value, 1));
  return value * lamp.irradiance / (lamp.at_point ? distance * distance : 1.0F);
}

} // namespace

std::vector<float> cpu_frame(const ViewScene& scene, const Lamp& lamp, int width, int height) {
  const Camera camera(scene.description().camera, width, height);
  const auto across = static_cast<std::size_t>(width);
  std::vector<float> rgb(3 * across * static_cast<std::size_t>(height));
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    for (std::size_t x = 0; x < across; ++x) {
      const Ray ray =
          camera.generate_ray(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      Hit hit;
      if (!scene.shapes().intersect(ray, hit))
        continue;
      const Rgb colour = shade(scene, lamp, hit, -ray.direction);
      std::copy(colour.begin(), colour.end(), rgb.begin() + 3 * (y * across + x));
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

double relative_rms(const std::vector<float>& frame, const std::vector<float>& reference) {
  double error = 0;
  double energy = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double truth = static_cast<double>(reference[i]);
    error += (static_cast<double>(frame[i]) - truth) * (static_cast<double>(frame[i]) - truth);
    energy += truth * truth;
  }
  return energy > 0 ? std::sqrt(error / energy) : std::sqrt(error);
}

} // namespace haarlight::view
