#include <view/frame.h>

#include <view/shaders.h>
#include <view/transfer.h>

#include <algorithm>
#include <chrono>

namespace haarlight::view {

using renderer::CameraDescription;
using renderer::Ray;

namespace {

std::vector<float> components(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// A ray's direction scaled so that it is linear in film coordinates.
Vec3 linear_direction(const Ray& ray, const CameraDescription& camera) {
  if (camera.projection == renderer::CameraProjection::Orthographic)
    return ray.direction;
  return ray.direction / ray.direction.dot((camera.to - camera.from).normalized());
}

void set_camera(const Program& program, const CameraDescription& description, int width,
                int height) {
  const renderer::Camera camera(description, width, height);
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  const Ray corner = camera.generate_ray(0, 0);
  const Ray right = camera.generate_ray(w, 0);
  const Ray down = camera.generate_ray(0, h);
  const Vec3 direction = linear_direction(corner, description);
  const Vec3 direction_y = (linear_direction(down, description) - direction) / h;
  program.set("ray_origin", components(corner.origin));
  program.set("ray_origin_x", components((right.origin - corner.origin) / w));
  program.set("ray_origin_y", components((down.origin - corner.origin) / h));
  program.set("ray_direction", components(direction));
  program.set("ray_direction_x",
              components((linear_direction(right, description) - direction) / w));
  program.set("ray_direction_y", components(direction_y));
  program.set("pixel_size",
              std::vector<float>{(down.origin - corner.origin).norm() / h, direction_y.norm()});
}

void set_punctual(const Program& program, const PunctualLight& light) {
  const Vec3 v = light.is_point ? light.place : light.place.normalized();
  program.set("light", std::vector<float>{v.x(), v.y(), v.z(), light.is_point ? 1.0F : 0.0F});
  program.set("irradiance", components(light.irradiance));
}

bool same_camera(const CameraDescription& a, const CameraDescription& b) {
  return a.projection == b.projection && a.from == b.from && a.to == b.to && a.up == b.up &&
         a.fov == b.fov && a.height == b.height;
}

} // namespace

bool ViewState::operator==(const ViewState& other) const {
  return same_camera(camera, other.camera) && width == other.width && height == other.height &&
         punctual == other.punctual && environment == other.environment &&
         to_world == other.to_world && background == other.background &&
         tolerance == other.tolerance && level == other.level;
}

PictureDrawer::PictureDrawer() : m_tone_map(full_screen_shader(), tone_map_shader()) {}

void PictureDrawer::resize(int width, int height) { m_target.emplace(width, height); }

void PictureDrawer::upload(const ShaderInputs& inputs,
                           const std::vector<const Program*>& programs) {
  for (const TextureData& texture : inputs.textures)
    m_textures.put(texture);
  for (const Program* program : programs) {
    for (const auto& [name, values] : inputs.floats)
      program->set(name, values);
    for (const auto& [name, value] : inputs.integers)
      program->set(name, value);
  }
}

double PictureDrawer::draw_with(const Program& program) const {
  m_textures.bind(program);
  const auto begin = std::chrono::steady_clock::now();
  m_target->draw(m_triangle);
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - begin;
  return passed.count();
}

DrawnFrame PictureDrawer::read() const {
  const std::vector<float> rgba = m_target->read();
  DrawnFrame frame;
  frame.rgb.resize(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < frame.rgb.size(); ++i)
    frame.rgb[i] = rgba[i / 3 * 4 + i % 3];
  std::size_t pixels = 0;
  for (std::size_t i = 3; i < rgba.size(); i += 4) { // shaders count accesses in alpha
    frame.accesses += static_cast<double>(rgba[i]);
    pixels += rgba[i] > 0 ? 1 : 0;
  }
  frame.accesses /= static_cast<double>(std::max<std::size_t>(pixels, 1));
  return frame;
}

void PictureDrawer::show(unsigned framebuffer, const Viewport& viewport, double exposure) const {
  const auto number = [](int value) { return static_cast<float>(value); };
  m_tone_map.set("viewport", std::vector<float>{number(viewport.x), number(viewport.y),
                                                number(viewport.width), number(viewport.height)});
  m_tone_map.set("exposure", std::vector<float>{static_cast<float>(exposure)});
  m_tone_map.set("picture", 0, m_target->texture());
  m_triangle.draw_to(framebuffer, viewport);
}

SceneDrawer::SceneDrawer(const ViewScene& scene)
    : m_punctual(full_screen_shader(), punctual_shader()),
      m_environment(full_screen_shader(), environment_shader()) {
  upload(pack_scene(scene), {&m_punctual, &m_environment}); // reports scenes that are too large
  upload(pack_lobes(scene), {&m_environment});
}

double SceneDrawer::draw(const ViewState& state) {
  if (!m_drawn || m_drawn->width != state.width || m_drawn->height != state.height)
    resize(state.width, state.height);
  if (state.environment && (!m_drawn || m_drawn->environment != state.environment))
    upload(state.environment->inputs, {&m_environment});
  m_drawn = state;
  const Program& program = state.environment ? m_environment : m_punctual;
  set_camera(program, state.camera, state.width, state.height);
  program.set("forced_level", state.level);
  if (state.environment) {
    program.set("to_world", state.to_world);
    program.set("show_background", state.background ? 1 : 0);
    program.set("tolerance", std::vector<float>{state.tolerance});
  } else {
    set_punctual(program, state.punctual);
  }
  return draw_with(program);
}

TransferDrawer::TransferDrawer(const ShaderInputs& transfer, int width, int height)
    : m_relight(full_screen_shader(), relight_shader()) {
  resize(width, height);
  upload(transfer, {&m_relight});
}

double TransferDrawer::draw(int level) const {
  m_relight.set("squares_end", squares_above(level));
  return draw_with(m_relight);
}

} // namespace haarlight::view
