#include <renderer/film/render.h>
#include <renderer/scene/affine_map.h>
#include <renderer/transfer/relight.h>

#include <wavelet/base/parallel.h>
#include <wavelet/product/adaptive_product.h>
#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <deque>

namespace haarlight::renderer {
namespace {

/// Maximum pixels along the side of the map from which rotated maps are sampled.
constexpr int side_max = 1024;

constexpr std::size_t pixels_at_once = 512;

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
    parallel_ranges(film.count(), pixels_at_once, [&](std::size_t begin, std::size_t end) {
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

} // namespace

Eigen::Matrix3f rotation_of(const Eigen::Vector3d& yaw_pitch_roll) {
  const AffineMap turn = rotation(Eigen::Vector3d::UnitY(), yaw_pitch_roll[0])
                             .then(rotation(Eigen::Vector3d::UnitX(), yaw_pitch_roll[1]))
                             .then(rotation(Eigen::Vector3d::UnitZ(), yaw_pitch_roll[2]));
  return turn.linear.cast<float>();
}

RotatedLight::RotatedLight(const Light& light, int resolution)
    : m_resolution(resolution), m_level(probe::make_rotatable(light.map(
                                    std::max(std::min(4 * resolution, side_max), resolution)))) {
  for (int axis = 0; axis < 3; ++axis)
    m_placed.col(axis) = light.to_world(Vec3::Unit(axis));
}

wavelet::Map RotatedLight::map(const Eigen::Matrix3f& turn) const {
  const Eigen::Matrix3f back = m_placed.transpose() * turn.transpose() * m_placed;
  return probe::rotate_map(m_level, {back.col(0), back.col(1), back.col(2)}, m_resolution);
}

std::unique_ptr<Relighter> light_relighter(const Transfer& transfer,
                                           const SceneDescription& scene) {
  return std::make_unique<LightRelighter>(transfer, scene);
}

std::unique_ptr<Relighter> reflectance_relighter(const Transfer& transfer,
                                                 const SceneDescription& scene,
                                                 const Variation& variation) {
  return std::make_unique<ReflectanceRelighter>(transfer, scene, variation);
}

std::unique_ptr<Relighter> make_relighter(const Transfer& transfer, const SceneDescription& scene,
                                          const Variation& variation) {
  switch (variation.varying) {
  case Varying::Light:
    return light_relighter(transfer, scene);
  case Varying::Object:
    return object_relighter(transfer, scene, variation);
  default:
    return reflectance_relighter(transfer, scene, variation);
  }
}

} // namespace haarlight::renderer
