#include <view/frame.h>

#include <view/shaders.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace haarlight::view {

using namespace renderer;

namespace {

std::vector<float> list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// A ray's direction, long enough to be linear in the film's coordinates.
Vec3 towards(const Ray& ray, const CameraDescription& camera) {
  if (camera.projection == CameraProjection::Orthographic)
    return ray.direction;
  return ray.direction / ray.direction.dot((camera.to - camera.from).normalized());
}

} // namespace

FrameDrawer::FrameDrawer(const ViewScene& scene, int width, int height)
    : m_lamp(covering_vertex_shader(), lamp_fragment_shader()),
      m_environment(covering_vertex_shader(), environment_fragment_shader()),
      m_show(covering_vertex_shader(), show_fragment_shader()),
      m_camera(scene.description().camera) {
  resize(width, height);
  put(pack_scene(scene));
  put(pack_reflectances(scene));
  set_lamp({});
  turn_light(Eigen::Matrix3f::Identity());
  show_background(true);
  set_tolerance(environment_tolerance);
}

void FrameDrawer::put(const PackedScene& packed) {
  for (const PackedTexture& texture : packed.textures)
    m_textures.put(texture);
  for (const auto& [name, values] : packed.floats)
    set(name, values);
  for (const auto& [name, value] : packed.integers)
    set(name, value);
}

void FrameDrawer::set_light(const PackedLight& light) { put(pack_light_textures(light)); }

void FrameDrawer::turn_light(const Eigen::Matrix3f& to_world) const { set("to_world", to_world); }

void FrameDrawer::show_background(bool shown) const { set("background", shown ? 1 : 0); }

void FrameDrawer::set_tolerance(float tolerance) const {
  set("tolerance", std::vector<float>{tolerance});
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
  set("ray_origin", list(corner.origin));
  set("ray_origin_x", list((right.origin - corner.origin) / w));
  set("ray_origin_y", list((down.origin - corner.origin) / h));
  set("ray_towards", list(direction));
  set("ray_towards_x", list((towards(right, m_camera) - direction) / w));
  set("ray_towards_y", list(direction_y));
  set("pixel_size",
      std::vector<float>{(down.origin - corner.origin).norm() / h, direction_y.norm()});
}

void FrameDrawer::set_lamp(const Lamp& lamp) const {
  const Vec3 v = lamp.at_point ? lamp.place : lamp.place.normalized();
  set("lamp", std::vector<float>{v.x(), v.y(), v.z(), lamp.at_point ? 1.0F : 0.0F});
  set("irradiance", std::vector<float>{lamp.irradiance[0], lamp.irradiance[1], lamp.irradiance[2]});
}

double FrameDrawer::draw(Lighting lighting, int level) const {
  const Program& program = lighting == Lighting::Lamp ? m_lamp : m_environment;
  program.set("forced_level", level);
  m_textures.bind(program);
  const auto begin = std::chrono::steady_clock::now();
  m_canvas->draw(m_cover);
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - begin;
  return passed.count();
}

DrawnFrame read_frame(const Canvas& canvas) {
  const std::vector<float> rgba = canvas.read();
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

void show_picture(const Canvas& canvas, const Program& show, const Cover& cover,
                  unsigned framebuffer, const Area& area, double exposure) {
  const auto number = [](int value) { return static_cast<float>(value); };
  show.set("area", std::vector<float>{number(area.x), number(area.y), number(area.width),
                                      number(area.height)});
  show.set("exposure", std::vector<float>{static_cast<float>(exposure)});
  show.set("picture", 0, canvas.texture());
  cover.draw_to(framebuffer, area);
}

} // namespace haarlight::view
