#include <renderer/transfer/transfer.h>

#include <renderer/scene/camera.h>

#include <wavelet/base/parallel.h>

namespace haarlight::renderer {
namespace {

/// The scene's shapes but one, and the scene's numbers of them.
struct Shapes {
  ShapeSet set;
  std::vector<int> numbers;

  Shapes(const SceneDescription& scene, int without) {
    for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i)
      if (i != without) {
        const ObjectDescription& object = scene.objects[static_cast<std::size_t>(i)];
        set.add(object.shape, object.transform);
        numbers.push_back(i);
      }
  }
};

FilmPoint find_point(const Shapes& shapes, const Ray& ray) {
  FilmPoint point;
  point.wo = -ray.direction;
  if (!shapes.set.intersect(ray, point.hit))
    return point;
  if (point.hit.normal.dot(ray.direction) > 0)
    point.hit.normal = -point.hit.normal;
  point.hit.object = shapes.numbers[static_cast<std::size_t>(point.hit.object)];
  return point;
}

} // namespace

std::vector<FilmPoint> film_points(const SceneDescription& scene, int width, int height,
                                   int without) {
  const Shapes shapes(scene, without);
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

} // namespace haarlight::renderer
