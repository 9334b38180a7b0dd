#include <renderer/scene/camera.h>
#include <renderer/transfer/transfer.h>

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/input_file.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

namespace haarlight::renderer {
namespace {

/// The scene's shapes except one, and their object indices in the scene.
struct ShapesWithout {
  ShapeSet set;
  std::vector<int> numbers;

  ShapesWithout(const SceneDescription& scene, int without) {
    for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i)
      if (i != without) {
        const ObjectDescription& object = scene.objects[static_cast<std::size_t>(i)];
        set.add(object.shape, object.transform);
        numbers.push_back(i);
      }
  }
};

FilmPoint find_point(const ShapesWithout& shapes, const Ray& ray) {
  FilmPoint point;
  point.wo = -ray.direction;
  if (!shapes.set.intersect(ray, point.hit))
    return point;
  if (point.hit.normal.dot(ray.direction) > 0)
    point.hit.normal = -point.hit.normal;
  point.hit.object = shapes.numbers[static_cast<std::size_t>(point.hit.object)];
  return point;
}

constexpr std::size_t batch_pixels = 4096;

/// A tree and the report on it.
struct BuiltTree {
  wavelet::Tree tree;
  wavelet::ProjectionReport report;
};

void account(const BuiltTree& built, const std::string& scene_path, TransferReport& sums) {
  if (built.report.squares == 0)
    return;
  if (!std::isfinite(built.report.dropped + built.report.unresolved))
    throw_input_error(scene_path,
                      "light and reflectances are too large for a transfer: the squares "
                      "of their products exceed the largest single-precision number; "
                      "the light must be scaled down");
  ++sums.pixels;
  sums.nodes += built.tree.links.size();
  sums.mean_squares += static_cast<double>(built.report.squares);
  sums.error += built.report.dropped;
  sums.unresolved += built.report.unresolved;
}

TransferReport averaged(TransferReport sums) {
  const double pixels = std::max(static_cast<double>(sums.pixels), 1.0);
  sums.mean_squares /= pixels;
  sums.error = std::sqrt(sums.error / pixels);
  sums.unresolved = std::sqrt(sums.unresolved / pixels);
  return sums;
}

/// Six significant digits in the C locale.
std::string number_text(double number) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << number;
  return text.str();
}

std::string units_of(Varying varying) {
  switch (varying) {
  case Varying::Light:
    return "f_r cos v, 1/sr";
  case Varying::Object:
    return "f_r cos L v, radiance per sr";
  default:
    return "L v, radiance";
  }
}

} // namespace

std::vector<FilmPoint> film_points(const SceneDescription& scene, int width, int height,
                                   int without) {
  const ShapesWithout shapes(scene, without);
  const Camera camera(scene.camera, width, height);
  std::vector<FilmPoint> points(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t x = i % static_cast<std::size_t>(width);
      const std::size_t y = i / static_cast<std::size_t>(width);
      points[i] = find_point(
          shapes, camera.generate_ray(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F));
    }
  });
  return points;
}

TransferBuilder::TransferBuilder(const LoadedScene& scene, const VisibilityTrees& visibility,
                                 const Variation& variation,
                                 const wavelet::ProjectionOptions& options,
                                 const std::vector<float>& light_variances)
    : m_scene(scene), m_variation(variation),
      m_options(options), m_light{scene.light().tree(), light_variances.data()},
      m_projector(options), m_occluders(visibility, scene.shapes().size(), options.levels) {}

wavelet::Tree TransferBuilder::constant(const Rgb& mean) const {
  wavelet::Tree tree;
  tree.levels = m_options.levels;
  tree.type = m_options.coefficients;
  tree.mean = mean;
  tree.level_begin.assign(static_cast<std::size_t>(tree.levels) + 1, 0);
  tree.coefficients.resize(8);
  return tree;
}

Rgb TransferBuilder::background(const FilmPoint& point) const {
  const Light& light = m_scene.light();
  if (m_variation.varying == Varying::Light || !m_scene.description().light.background)
    return Rgb::Zero();
  return light.radiance(light.to_light(-point.wo)) / wavelet::sphere_area;
}

bool TransferBuilder::varies(const FilmPoint& point) const {
  if (m_variation.varying != Varying::Material)
    return true;
  const auto object = static_cast<std::size_t>(point.hit.object);
  return m_scene.description().objects[object].material == m_variation.index;
}

wavelet::Tree TransferBuilder::make(const FilmPoint& point) {
  m_report = {};
  if (point.hit.object < 0)
    return constant(background(point));
  m_factors.clear();
  const int moved = m_variation.varying == Varying::Object ? m_variation.index : -1;
  for (const wavelet::TreeView& visibility : m_occluders.at(point.hit, moved))
    m_factors.push_back({visibility, nullptr});
  const bool varying = varies(point);
  const bool keeps_light = m_variation.varying != Varying::Light;
  const bool keeps_reflectance =
      m_variation.varying == Varying::Light || m_variation.varying == Varying::Object || !varying;
  if (keeps_light)
    m_factors.push_back(m_light);
  const Light& light = m_scene.light();
  const wavelet::RotatedReflectance reflectance =
      m_scene.material_of(point.hit.object)
          .reflectance(shading_point(light.to_light(point.hit.normal), light.to_light(point.wo)));
  wavelet::Tree tree = m_projector.make(m_factors, keeps_reflectance ? &reflectance : nullptr);
  if (!varying)
    return constant(tree.mean);
  m_report = m_projector.report();
  return tree;
}

double default_transfer_tolerance(Varying varying) {
  switch (varying) {
  case Varying::Light:
    return 0.15;
  case Varying::Object:
    return 0.8;
  default:
    return 0.5;
  }
}

wavelet::SetInfo transfer_info(const SceneDescription& scene, const Variation& variation,
                               const wavelet::ProjectionOptions& options, int width, int height) {
  wavelet::SetInfo info;
  info.kind = wavelet::SetKind::Transfer;
  info.size = 1 << options.levels;
  info.columns = width;
  info.rows = height;
  info.frame = "the light's: the world (right +x, up +y, forward -z) turned by the scene's rotate";
  info.units = units_of(variation.varying);
  Provenance& p = info.provenance;
  p.set("scene", base_name(scene.path));
  p.set("scene_hash", scene.hash);
  p.set("vary", variation_text(scene, variation));
  p.set("resolution", std::to_string(info.size));
  p.set("tolerance", number_text(options.tolerance));
  p.set("version", version_text());
  return info;
}

TransferReport build_transfer(const LoadedScene& scene, const Variation& variation,
                              const wavelet::ProjectionOptions& options, int width, int height,
                              wavelet::TreeSink& sink, const wavelet::Progress& progress) {
  const int moved = variation.varying == Varying::Object ? variation.index : -1;
  const std::vector<FilmPoint> points = film_points(scene.description(), width, height, moved);
  const VisibilityTrees visibility(scene.shapes(), scene.light());
  const std::vector<float> variances = wavelet::variances_within(scene.light().tree());
  TransferReport report;
  std::vector<BuiltTree> batch;
  for (std::size_t first = 0; first < points.size(); first += batch_pixels) {
    batch.clear();
    batch.resize(std::min(batch_pixels, points.size() - first));
    parallel_ranges(batch.size(), 64, [&](std::size_t begin, std::size_t end) {
      TransferBuilder maker(scene, visibility, variation, options, variances);
      for (std::size_t i = begin; i < end; ++i)
        batch[i] = {maker.make(points[first + i]), maker.report()};
    });
    for (BuiltTree& built : batch) {
      account(built, scene.description().path, report);
      sink.add(std::move(built.tree));
    }
    if (progress)
      progress(static_cast<int>(first + batch.size()), static_cast<int>(points.size()));
  }
  return averaged(report);
}

} // namespace haarlight::renderer
