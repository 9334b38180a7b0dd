#include <view/frame.h>

#include <view/packed_trees.h>
#include <view/shaders.h>

#include <wavelet/error.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace haarlight::view {

using namespace renderer;

namespace {

std::vector<float> list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// The two texels of each object that scene.glsl reads.
std::vector<float> object_texels(const ViewScene& scene) {
  const ShapeSet& shapes = scene.shapes();
  std::vector<float> texels(8 * static_cast<std::size_t>(shapes.size()));
  const auto put = [&](int object, const Eigen::Vector3d& v, double w, float kind) {
    const Columns& columns = scene.columns_of(object);
    const float both[8] = {static_cast<float>(v.x()),
                           static_cast<float>(v.y()),
                           static_cast<float>(v.z()),
                           static_cast<float>(w),
                           kind,
                           static_cast<float>(columns.first),
                           static_cast<float>(columns.count),
                           static_cast<float>(columns.levels)};
    std::copy(both, both + 8, &texels[8 * static_cast<std::size_t>(object)]);
  };
  for (const detail::Solid& solid : shapes.solids())
    put(solid.object, solid.center, solid.radius, 0);
  for (const detail::WorldPlane& plane : shapes.planes())
    put(plane.object, plane.normal, plane.height, 1);
  return texels;
}

/// A ray's direction, long enough to be linear in the film's coordinates.
Vec3 towards(const Ray& ray, const CameraDescription& camera) {
  if (camera.projection == Projection::Orthographic)
    return ray.direction;
  return ray.direction / ray.direction.dot((camera.to - camera.from).normalized());
}

void check_nodes(const std::vector<wavelet::TreeView>& trees) {
  std::uint64_t nodes = 0;
  for (const wavelet::TreeView& tree : trees)
    nodes += tree.node_count;
  if (nodes >= 1U << 28U)
    throw_output_error("GL", "trees of " + std::to_string(nodes) +
                                 " nodes are to be shown; 2^28 - 1 are possible");
}

} // namespace

FrameDrawer::FrameDrawer(const ViewScene& scene, int width, int height)
    : m_lamp(covering_vertex_shader(), lamp_fragment_shader()),
      m_show(covering_vertex_shader(), show_fragment_shader()),
      m_camera(scene.description().camera) {
  resize(width, height);
  add_trees(scene);
  add_objects(scene);
  set_lamp({});
}

void FrameDrawer::add(const std::string& name, Texture texture) {
  m_textures.emplace_back(name, std::move(texture));
}

void FrameDrawer::add_trees(const ViewScene& scene) {
  check_nodes(scene.trees());
  const PackedTrees packed = pack_trees(scene.trees());
  add("tops", Texture(slice_width, slice_height, packed.columns, packed.tops.data()));
  add("starts", Texture(Texel::R32Ui, top_side * top_side, packed.columns, packed.starts.data()));
  add("scales", Texture(Texel::R32F, packed.columns, 1, packed.scales.data()));
  add("links", Texture(Texel::R32Ui, nodes_per_row, packed.node_rows, packed.links.data()));
  add("coefficients",
      Texture(Texel::Rgba16F, 3 * nodes_per_row, packed.node_rows, packed.coefficients.data()));
  m_lamp.set("top_unit", std::vector<float>{packed.top_unit});
  m_texture_bytes += packed.bytes();
}

void FrameDrawer::add_objects(const ViewScene& scene) {
  const int count = scene.shapes().size();
  const std::vector<float> texels = object_texels(scene);
  add("objects",
      Texture(Texel::Rgba32F, 2, std::max(count, 1), count > 0 ? texels.data() : nullptr));
  m_lamp.set("object_count", count);
  m_texture_bytes += 4 * texels.size();
}

void FrameDrawer::resize(int width, int height) {
  m_canvas.emplace(width, height);
  aim();
}

void FrameDrawer::set_camera(const CameraDescription& camera) {
  m_camera = camera;
  aim();
}

void FrameDrawer::aim() const {
  const Area area = m_canvas->area();
  const Camera camera(m_camera, area.width, area.height);
  const auto w = static_cast<float>(area.width);
  const auto h = static_cast<float>(area.height);
  const Ray corner = camera.generate_ray(0, 0);
  const Ray right = camera.generate_ray(w, 0);
  const Ray down = camera.generate_ray(0, h);
  const Vec3 direction = towards(corner, m_camera);
  const Vec3 direction_y = (towards(down, m_camera) - direction) / h;
  m_lamp.set("ray_origin", list(corner.origin));
  m_lamp.set("ray_origin_x", list((right.origin - corner.origin) / w));
  m_lamp.set("ray_origin_y", list((down.origin - corner.origin) / h));
  m_lamp.set("ray_towards", list(direction));
  m_lamp.set("ray_towards_x", list((towards(right, m_camera) - direction) / w));
  m_lamp.set("ray_towards_y", list(direction_y));
  m_lamp.set("pixel_size",
             std::vector<float>{(down.origin - corner.origin).norm() / h, direction_y.norm()});
}

void FrameDrawer::set_lamp(const Lamp& lamp) const {
  const Vec3 v = lamp.at_point ? lamp.place : lamp.place.normalized();
  m_lamp.set("lamp", std::vector<float>{v.x(), v.y(), v.z(), lamp.at_point ? 1.0F : 0.0F});
  m_lamp.set("irradiance",
             std::vector<float>{lamp.irradiance[0], lamp.irradiance[1], lamp.irradiance[2]});
}

double FrameDrawer::draw(int level) const {
  m_lamp.set("forced_level", level);
  int unit = 0;
  for (const auto& [name, texture] : m_textures)
    m_lamp.set(name, unit++, texture);
  const auto begin = std::chrono::steady_clock::now();
  m_canvas->draw(m_cover);
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - begin;
  return passed.count();
}

DrawnFrame FrameDrawer::read() const {
  const std::vector<float> rgba = m_canvas->read();
  DrawnFrame frame;
  frame.rgb.resize(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < frame.rgb.size(); ++i)
    frame.rgb[i] = rgba[i / 3 * 4 + i % 3];
  std::size_t pixels = 0;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    frame.accesses += static_cast<double>(rgba[i]);
    pixels += rgba[i] > 0 ? 1 : 0;
  }
  frame.accesses /= static_cast<double>(std::max<std::size_t>(pixels, 1));
  return frame;
}

void FrameDrawer::show(unsigned framebuffer, const Area& area, double exposure) const {
  const auto number = [](int value) { return static_cast<float>(value); };
  m_show.set("area", {number(area.x), number(area.y), number(area.width), number(area.height)});
  m_show.set("exposure", std::vector<float>{static_cast<float>(exposure)});
  m_show.set("picture", 0, m_canvas->texture());
  m_cover.draw_to(framebuffer, area);
}

} // namespace haarlight::view
