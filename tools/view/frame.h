#pragma once
// Pictures of a scene under a lamp, drawn by GL, for whatever owns the context.

#include <view/gl_objects.h>
#include <view/gl_textures.h>
#include <view/packed_scene.h>
#include <view/view_scene.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::view {

enum class Lighting { Lamp, Environment };

/// The level that the pixel needs.
inline constexpr int automatic_level = -1;

/// Squares of a distant light are split while each leaves more than this share of a pixel in doubt,
/// by estimate.
inline constexpr float environment_tolerance = 3e-3F;

/// What was drawn.
struct DrawnFrame {
  std::vector<float> rgb; ///< linear, top row first
  double accesses = 0;    ///< of textures that hold trees, on average over pixels that have any
};

/// What a shader drew that leaves the number of its accesses in alpha.
DrawnFrame read_frame(const Canvas& canvas);

/// Puts a picture, tone-mapped, into an area of a framebuffer by the program of show.glsl.
void show_picture(const Canvas& canvas, const Program& show, const Cover& cover,
                  unsigned framebuffer, const Area& area, double exposure);

/// A scene's trees and shapes in textures, and the image they are drawn to. Needs the same current
/// context all its life, of OpenGL ES 3.0 that draws to float images, or of OpenGL 3.3; expects
/// nothing of its state but that blending, depth, stencil and scissor tests are off.
class FrameDrawer {
public:
  /// @param scene needed by the constructor only
  /// @throws Error(Output) if the scene or the picture is larger than GL takes
  FrameDrawer(const ViewScene& scene, int width, int height);

  /// Pictures of another size from now on. @throws Error(Output) if it is larger than GL takes
  void resize(int width, int height);
  void set_camera(const renderer::CameraDescription& camera);
  void set_lamp(const Lamp& lamp) const;

  /// The light that Lighting::Environment draws by, from now on.
  /// @throws Error(Output) if it is larger than GL takes
  void set_light(const PackedLight& light);
  /// How that is turned: from its frame to the world's.
  void turn_light(const Eigen::Matrix3f& to_world) const;
  /// Whether it is seen where there is no object; yes if it is not said.
  void show_background(bool shown) const;
  void set_tolerance(float tolerance) const;

  /// Draws and waits until that is done.
  /// @param lighting Environment only after set_light()
  /// @param level of the trees' averages, 0 … 13, or automatic_level; levels beyond a set's own are
  ///        its full level. By Environment: of the finest squares of light that are told apart
  /// @return milliseconds
  double draw(Lighting lighting, int level) const;

  /// The picture drawn last.
  DrawnFrame read() const { return read_frame(*m_canvas); }

  /// Puts the picture drawn last, tone-mapped, into an area of a framebuffer.
  /// @param framebuffer GL's name for it, 0 being the window
  /// @param exposure stops
  void show(unsigned framebuffer, const Area& area, double exposure) const {
    show_picture(*m_canvas, m_show, m_cover, framebuffer, area, exposure);
  }

  /// Bytes of all textures.
  std::size_t texture_bytes() const { return m_textures.bytes(); }

private:
  /// Adds textures and uniforms, or replaces those of the same names.
  void put(const PackedScene& packed);
  template <class Value>
  void set(const std::string& name, const Value& value) const {
    m_lamp.set(name, value);
    m_environment.set(name, value);
  }
  void aim() const;

  Cover m_cover;
  Program m_lamp;
  Program m_environment;
  Program m_show;
  renderer::CameraDescription m_camera;
  std::optional<Canvas> m_canvas;
  NamedTextures m_textures;
};

} // namespace haarlight::view
