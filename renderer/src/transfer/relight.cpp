#include "visibility/cap.h"

#include <renderer/film/render.h>
#include <renderer/scene/affine_map.h>
#include <renderer/transfer/relight.h>

#include <wavelet/base/parallel.h>
#include <wavelet/product/adaptive_product.h>
#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/tree/tree.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <vector>

namespace haarlight::renderer {
namespace {

using namespace detail;
using wavelet::RegionPart;
using wavelet::Square;

/// Maximum pixels along the side of the map from which rotated maps are sampled.
constexpr int max_source_side = 1024;

constexpr std::size_t pixels_per_range = 512;

/// The light is rotated or replaced: inner products with its coefficients. Background pixels show
/// the light.
class LightRelighter : public Relighter {
public:
  LightRelighter(const Transfer& transfer, const SceneDescription& scene)
      : m_transfer(transfer), m_shown(scene.light.background),
        m_light(scene.light, SourceLookups().probe), m_turned(m_light, transfer.resolution()),
        m_points(film_points(scene, transfer.width(), transfer.height())) {}

  Film make(const Change& change) override {
    const Eigen::Matrix3f turn = rotation_of(change.rotate);
    const wavelet::DenseCoefficients light(m_turned.map(turn));
    Film film(m_transfer.width(), m_transfer.height());
    parallel_ranges(film.count(), pixels_per_range, [&](std::size_t begin, std::size_t end) {
      std::vector<Rgb> means(end - begin);
      light.inner_products(m_transfer.trees().subspan(begin, end - begin), means);
      for (std::size_t i = begin; i < end; ++i)
        film.set_color(i, m_points[i].hit.object < 0
                              ? background(m_points[i], turn)
                              : Rgb((means[i - begin] * wavelet::sphere_area).max(0.0F)));
    });
    return film;
  }

private:
  Rgb background(const FilmPoint& point, const Eigen::Matrix3f& turn) const {
    return m_shown ? m_light.radiance(m_light.to_light(turn.transpose() * -point.wo))
                   : Rgb(Rgb::Zero());
  }

  const Transfer& m_transfer;
  bool m_shown;
  Light m_light;
  RotatedLight m_turned;
  std::vector<FilmPoint> m_points;
};

/// One material is replaced, or all points are seen from another eye: products of the trees with
/// reflectances evaluated per square. The points stay those of the transfer's film, so that only
/// highlights move with the eye; points facing away from it are black.
class ReflectanceRelighter : public Relighter {
public:
  ReflectanceRelighter(const Transfer& transfer, const SceneDescription& scene,
                       const Variation& variation)
      : m_transfer(transfer), m_scene(scene), m_variation(variation),
        m_light(scene.light, SourceLookups().probe),
        m_points(film_points(scene, transfer.width(), transfer.height())) {
    m_options.variance_bound = integral_variance_bound;
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
      if (variation.varying == Varying::View || static_cast<int>(i) == variation.index)
        load(i);
  }

  Film make(const Change& change) override {
    Film film(m_transfer.width(), m_transfer.height());
    parallel_ranges(film.count(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        film.set_color(i, radiance(m_points[i], m_transfer.trees()[i], change));
    });
    return film;
  }

private:
  void load(std::size_t index) {
    m_materials.resize(m_scene.materials.size(), nullptr);
    m_loaded.emplace_back(m_scene.materials[index], SourceLookups().brdf);
    m_loaded.back().require_trees();
    m_materials[index] = &m_loaded.back();
  }

  Rgb radiance(const FilmPoint& point, const wavelet::TreeView& tree, const Change& change) const {
    const Material* material = point.hit.object < 0 ? nullptr : material_of(point.hit.object);
    if (material == nullptr)
      return tree.mean * wavelet::sphere_area;
    const Vec3 wo = to_viewer(point, change);
    if (!(point.hit.normal.dot(wo) > 0))
      return Rgb::Zero();
    wavelet::AdaptiveProduct product(tree);
    const ShadingPoint shaded =
        shading_point(m_light.to_light(point.hit.normal), m_light.to_light(wo));
    return product.build(material->reflectance(shaded), m_options).integral() *
           wavelet::sphere_area;
  }

  /// Null for pixels that do not vary.
  const Material* material_of(int object) const {
    const int material = m_scene.objects[static_cast<std::size_t>(object)].material;
    return m_materials[static_cast<std::size_t>(material)];
  }

  /// For orthographic cameras the view direction is from the camera's target to the moved eye.
  Vec3 to_viewer(const FilmPoint& point, const Change& change) const {
    if (m_variation.varying != Varying::View || change.move.isZero())
      return point.wo;
    const CameraDescription& camera = m_scene.camera;
    const Vec3 eye = camera.from + change.move;
    const bool parallel = camera.projection == CameraProjection::Orthographic;
    return (eye - (parallel ? camera.to : point.hit.position)).normalized();
  }

  const Transfer& m_transfer;
  const SceneDescription& m_scene;
  Variation m_variation;
  Light m_light;
  std::vector<FilmPoint> m_points;
  wavelet::AdaptiveOptions m_options;
  std::deque<Material> m_loaded;
  std::vector<const Material*> m_materials; ///< by index; null for those that do not vary
};

/// Integrates trees over caps: squares inside count with their averages, and only squares that the
/// cap's edge crosses are descended into. Shared by threads.
class SphereOcclusion {
public:
  SphereOcclusion() {
    std::vector<Square> places = {Square{}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      m_bounds.push_back(wavelet::square_cap(places[i]));
      if (places[i].level < finest_level)
        for (unsigned q = 0; q < 4; ++q)
          places.push_back(places[i].quadrant(q));
    }
  }

  /// ∫∫ T over the cap, per channel; the whole square's area is 1.
  Rgb integral(const wavelet::TreeView& tree, const Cap& cap) const {
    const Walk walk = {tree, cap, negligible_fraction * luminance(tree.mean)};
    return wavelet::to_rgb(integral(walk, tree.root(), wavelet::to_lanes(tree.mean), {0, 0}));
  }

private:
  /// A cap's edge is treated as straight within constant squares of at least this level and at most
  /// this size relative to the cap, …
  static constexpr int straight_level = 5;
  static constexpr float straight_fraction = 0.25F;
  /// … within all squares of this level, …
  static constexpr int finest_level = 8;
  /// … and within squares that contain less than this fraction of the integral.
  static constexpr float negligible_fraction = 1e-3F;
  /// Half a square's mean width over the radius of its bounding circle.
  static constexpr float half_width = 0.8F;

  struct Walk {
    const wavelet::TreeView& tree;
    const Cap& cap;
    float negligible; ///< luminance times area
  };
  struct Place {
    std::uint32_t index; ///< in a complete tree: quadrant q of i is 4 i + 1 + q
    int level;
  };

  /// The fraction of a square inside the cap, from the distance of its centre to the cap's edge.
  static float fraction_inside(const wavelet::SquareCap& bounds, const Cap& cap) {
    const float along = cap.axis.dot(bounds.centre);
    const float across = std::sqrt(std::max(1 - along * along, 0.0F));
    const float inside = cap.sine * along - cap.cosine * across;
    return std::clamp(0.5F + 0.5F * inside / (half_width * bounds.sine), 0.0F, 1.0F);
  }

  Float4 integral(const Walk& walk, std::uint32_t node, Float4 mean, const Place& square) const {
    const wavelet::SquareCap& bounds = m_bounds[square.index];
    const float weight = wavelet::lane_sum(mean * wavelet::luminance_lanes);
    const RegionPart part = walk.cap.classify(bounds);
    if (part == RegionPart::Outside || !(weight > 0))
      return Float4{};
    if (part == RegionPart::Inside)
      return mean;
    const bool constant = node == wavelet::no_node;
    const bool straight =
        square.level >= straight_level && bounds.sine <= straight_fraction * walk.cap.sine;
    if (square.level == finest_level ||
        weight * power_of_two(-2 * square.level) <= walk.negligible || (constant && straight))
      return mean * fraction_inside(bounds, walk.cap);
    const wavelet::TreeQuadrants quadrants = walk.tree.split(node, mean);
    Float4 sum = {};
    for (unsigned q = 0; q < 4; ++q)
      sum += integral(walk, quadrants.nodes[q], quadrants.means[q],
                      {4 * square.index + 1 + q, square.level + 1});
    return 0.25F * sum;
  }

  std::vector<wavelet::SquareCap> m_bounds; ///< as in a complete tree
};

/// The moved object alone.
class MovedObject {
public:
  MovedObject(const ObjectDescription& object, const Vec3& move, const Light& light)
      : m_light(light) {
    m_shapes.add(object.shape, object.transform.then(translation(move.cast<double>())));
    m_visibility.emplace(m_shapes, light);
  }

  /// The nearest hit of a ray.
  bool intersect(const Ray& ray, Hit& hit) const { return m_shapes.intersect(ray, hit); }

  /// ∫∫ of a tree over the directions that the object occludes at a point.
  Rgb occluded_part(const Hit& from, const wavelet::TreeView& tree,
                    const SphereOcclusion& occlusion) const {
    if (m_shapes.solids().empty())
      return occluded_by_tree(from, tree);
    const Solid& solid = m_shapes.solids().front();
    const Eigen::Vector3d origin = leave(from, from.normal).origin.cast<double>();
    const Eigen::Vector3d centre = solid.center - origin;
    if (centre.dot(from.normal.cast<double>()) < -solid.radius) // below the horizon
      return Rgb::Zero();
    if (solid.kind != SolidKind::WorldSphere)
      return occluded_by_tree(from, tree);
    Cap cap = Cap::around_ball(centre, solid.radius);
    cap.axis = m_light.to_light(cap.axis);
    return occlusion.integral(tree, cap);
  }

private:
  Rgb occluded_by_tree(const Hit& from, const wavelet::TreeView& tree) const {
    Hit elsewhere = from;
    elsewhere.object = -1;
    const wavelet::Tree seen = m_visibility->object(0, elsewhere, tree.levels);
    return tree.mean - wavelet::inner_product(tree, seen.view());
  }

  const Light& m_light;
  ShapeSet m_shapes;
  std::optional<VisibilityTrees> m_visibility;
};

/// Shades the moved object: the integral of the product of light and reflectance over the leaves
/// whose centres are not occluded by other objects. Products of neighbouring points are updated.
class ObjectShader {
public:
  ObjectShader(const LoadedScene& scene, int object)
      : m_scene(scene), m_object(object), m_product(scene.light().tree()) {
    m_options.reuse_variance_bound = 0; // each point needs its own integral
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
    const wavelet::ProductTree& product = m_has_previous
                                              ? m_product.build_or_reuse(reflectance, m_options)
                                              : m_product.build(reflectance, m_options);
    m_has_previous = true;
    Float4 sum = {};
    for (const wavelet::ProductNode& node : product.nodes())
      for (const std::int32_t child : node.child)
        if (child < 0)
          sum += visible_part(hit, product.leaf(child));
    return wavelet::to_rgb(sum) * wavelet::sphere_area;
  }

private:
  Float4 visible_part(const Hit& hit, const wavelet::ProductLeaf& leaf) const {
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
  bool m_has_previous = false;
};

/// One object and its shadows move: the occluded part of each tree is subtracted. The object itself
/// is shaded by the scene's light with the shadows of the other objects.
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
    return ((tree.mean - moved.occluded_part(point.hit, tree, m_occlusion)) * wavelet::sphere_area)
        .max(0.0F);
  }

  const Transfer& m_transfer;
  LoadedScene m_scene;
  int m_object;
  std::vector<FilmPoint> m_points;
  SphereOcclusion m_occlusion;
};

} // namespace

Eigen::Matrix3f rotation_of(const Eigen::Vector3d& yaw_pitch_roll) {
  const AffineMap turn = rotation(Eigen::Vector3d::UnitY(), yaw_pitch_roll[0])
                             .then(rotation(Eigen::Vector3d::UnitX(), yaw_pitch_roll[1]))
                             .then(rotation(Eigen::Vector3d::UnitZ(), yaw_pitch_roll[2]));
  return turn.linear.cast<float>();
}

RotatedLight::RotatedLight(const Light& light, int resolution)
    : m_resolution(resolution),
      m_level(probe::make_rotatable(
          light.map(std::max(std::min(4 * resolution, max_source_side), resolution)))) {
  for (int axis = 0; axis < 3; ++axis)
    m_placed.col(axis) = light.to_world(Vec3::Unit(axis));
}

wavelet::Map RotatedLight::map(const Eigen::Matrix3f& turn) const {
  const Eigen::Matrix3f back = m_placed.transpose() * turn.transpose() * m_placed;
  return probe::rotate_map(m_level, {back.col(0), back.col(1), back.col(2)}, m_resolution);
}

std::unique_ptr<Relighter> make_relighter(const Transfer& transfer, const SceneDescription& scene,
                                          const Variation& variation) {
  switch (variation.varying) {
  case Varying::Light:
    return std::make_unique<LightRelighter>(transfer, scene);
  case Varying::Object:
    return std::make_unique<ObjectRelighter>(transfer, scene, variation);
  default:
    return std::make_unique<ReflectanceRelighter>(transfer, scene, variation);
  }
}

} // namespace haarlight::renderer
