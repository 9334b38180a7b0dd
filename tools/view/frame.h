#pragma once
// Pictures of a scene under a lamp, drawn by GL, for whatever owns the context.

#include <view/gl_objects.h>
#include <view/view_scene.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::view {

/// The level that the pixel needs.
inline constexpr int automatic_level = -1;

/// What was drawn.
struct DrawnFrame {
  std::vector<float> rgb; ///< linear, top row first
  double accesses = 0;    ///< of textures that hold trees, on average over pixels that have any
};

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

  /// Draws and waits until that is done.
  /// @param level of the trees' averages, 0 … 13, or automatic_level; levels beyond a set's own are
  ///        its full level
  /// @return milliseconds
  double draw(int level) const;

  /// The picture drawn last.
  DrawnFrame read() const;

  /// Puts the picture drawn last, tone-mapped, into an area of a framebuffer.
  /// @param framebuffer GL's name for it, 0 being the window
  /// @param exposure stops
  void show(unsigned framebuffer, const Area& area, double exposure) const;

  /// Bytes of all textures.
  std::size_t texture_bytes() const { return m_texture_bytes; }

private:
  void add(const std::string& name, Texture texture);
  void add_trees(const ViewScene& scene);
  void add_objects(const ViewScene& scene);
  void aim() const;

  Cover m_cover;
  Program m_lamp;
  Program m_show;
  renderer::CameraDescription m_camera;
  std::optional<Canvas> m_canvas;
  std::vector<std::pair<std::string, Texture>> m_textures; ///< with the samplers' names
  std::size_t m_texture_bytes = 0;
};

} // namespace haarlight::view
