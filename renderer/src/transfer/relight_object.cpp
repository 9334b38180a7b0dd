// Transfer that is all but one object's visibility: the object moves, its shadow with it.
#include <renderer/transfer/relight.h>

#include "transfer/hidden_share.h"

#include <wavelet/base/parallel.h>
#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>

#include <optional>

namespace haarlight::renderer {
namespace {

/// The moved object by itself.
class MovedObject {
public:
  MovedObject(const ObjectDescription& object, const Vec3& move, const Light& light)
      : m_light(light) {
    m_shapes.add(object.shape, object.transform.then(translation(move.cast<double>())));
    m_visibility.emplace(m_shapes, light);
  }

  /// The nearest hit on it, if nothing else is nearer.
  bool intersect(const Ray& ray, Hit& hit) const { return m_shapes.intersect(ray, hit); }

  /// ∫∫ of a tree over the directions that the object hides from a point.
  Rgb hidden(const Hit& from, const wavelet::TreeView& tree,
             const detail::HiddenShare& share) const {
    if (m_shapes.solids().empty())
      return hidden_by_tree(from, tree);
    const detail::Solid& solid = m_shapes.solids().front();
    const Eigen::Vector3d origin = leave(from, from.normal).origin.cast<double>();
    const Eigen::Vector3d centre = solid.center - origin;
    if (centre.dot(from.normal.cast<double>()) < -solid.radius) // below the horizon, as nothing is
      return Rgb::Zero();
    if (solid.kind != detail::SolidKind::WorldSphere)
      return hidden_by_tree(from, tree);
    detail::Cap cap = detail::Cap::around_ball(centre, solid.radius);
    cap.axis = m_light.to_light(cap.axis);
    return share.within(tree, cap);
  }

private:
  Rgb hidden_by_tree(const Hit& from, const wavelet::TreeView& tree) const {
    Hit elsewhere = from;
    elsewhere.object = -1;
    const wavelet::Tree seen = m_visibility->object(0, elsewhere, tree.levels);
    return tree.mean - wavelet::inner_product(tree, seen.view());
  }

  const Light& m_light;
  ShapeSet m_shapes;
  std::optional<VisibilityTrees> m_visibility;
};

/// Shades the moved object itself: the product of light and reflectance, of whose squares those
/// count whose centres nothing else hides. Each product follows the last, of a point that should
/// be close by.
class ObjectShader {
public:
  ObjectShader(const LoadedScene& scene, int object)
      : m_scene(scene), m_object(object), m_product(scene.light().tree()) {
    m_options.reuse_variance_bound = 0; // integrals have to be each point's own
    for (int i = 0; i < static_cast<int>(scene.description().objects.size()); ++i) {
      const ObjectDescription& other = scene.description().objects[static_cast<std::size_t>(i)];
      if (i != object)
        m_others.add(other.shape, other.transform);
    }
  }

  Rgb shade(const Hit& hit, const Vec3& wo) {
    const Light& light = m_scene.light();
    const ShadingPoint point = shading_point(light.to_light(hit.normal), light.to_light(wo));
    const wavelet::RotatedReflectance reflectance =
        m_scene.material_of(m_object).reflectance(point);
    const wavelet::ProductTree& product = m_follows
                                              ? m_product.build_or_reuse(reflectance, m_options)
                                              : m_product.build(reflectance, m_options);
    m_follows = true;
    Float4 sum = {};
    for (const wavelet::ProductNode& node : product.nodes())
      for (const std::int32_t child : node.child)
        if (child < 0)
          sum += seen_share(hit, product.leaf(child));
    return wavelet::to_rgb(sum) * wavelet::sphere_area;
  }

private:
  Float4 seen_share(const Hit& hit, const wavelet::ProductLeaf& leaf) const {
    const Float4 value = leaf.light * leaf.reflectance * leaf.square.area();
    if (!(wavelet::lane_sum(value * wavelet::luminance_lanes) > 0))
      return Float4{};
    const Vec3 w = m_scene.light().to_world(wavelet::square_to_sphere(leaf.square.centre()));
    return m_others.occluded(leave(hit, w)) ? Float4{} : value;
  }

  const LoadedScene& m_scene;
  int m_object;
  ShapeSet m_others;
  wavelet::AdaptiveOptions m_options;
  wavelet::AdaptiveProduct m_product;
  bool m_follows = false;
};

class ObjectRelighter : public Relighter {
public:
  ObjectRelighter(const Transfer& transfer, const SceneDescription& scene,
                  const Variation& variation)
      : m_transfer(transfer), m_scene(scene, SourceLookups(), SamplerKind::Product, false),
        m_object(variation.index),
        m_points(film_points(scene, transfer.width(), transfer.height(), m_object)) {}

  Film make(const Change& change) override {
    const SceneDescription& scene = m_scene.description();
    const MovedObject moved(scene.objects[static_cast<std::size_t>(m_object)], change.move,
                            m_scene.light());
    const Camera camera(scene.camera, m_transfer.width(), m_transfer.height());
    Film film(m_transfer.width(), m_transfer.height());
    const auto width = static_cast<std::size_t>(film.width);
    parallel_for(static_cast<std::size_t>(film.height), [&](std::size_t y) {
      ObjectShader shader(m_scene, m_object);
      for (std::size_t i = y * width; i < (y + 1) * width; ++i)
        film.set_color(i, radiance(i, moved, camera, shader));
    });
    return film;
  }

private:
  Rgb radiance(std::size_t pixel, const MovedObject& moved, const Camera& camera,
               ObjectShader& shader) const {
    const auto width = static_cast<std::size_t>(m_transfer.width());
    const std::size_t x = pixel % width;
    const std::size_t y = pixel / width;
    Ray ray = camera.generate_ray(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
    const FilmPoint& point = m_points[pixel];
    ray.t_max = std::min(ray.t_max, point.hit.t);
    Hit hit;
    if (moved.intersect(ray, hit)) {
      if (hit.normal.dot(ray.direction) > 0)
        hit.normal = -hit.normal;
      return shader.shade(hit, -ray.direction);
    }
    const wavelet::TreeView& tree = m_transfer.trees()[pixel];
    if (point.hit.object < 0)
      return tree.mean * wavelet::sphere_area;
    return ((tree.mean - moved.hidden(point.hit, tree, m_share)) * wavelet::sphere_area).max(0.0F);
  }

  const Transfer& m_transfer;
  LoadedScene m_scene;
  int m_object;
  std::vector<FilmPoint> m_points;
  detail::HiddenShare m_share;
};

} // namespace

std::unique_ptr<Relighter> object_relighter(const Transfer& transfer, const SceneDescription& scene,
                                            const Variation& variation) {
  return std::make_unique<ObjectRelighter>(transfer, scene, variation);
}

} // namespace haarlight::renderer
