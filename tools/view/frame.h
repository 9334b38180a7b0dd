#pragma once
// Pictures of a scene under a lamp, drawn by GL.

#include <view/gl_objects.h>
#include <view/view_scene.h>

#include <memory>
#include <vector>

namespace haarlight::view {

/// The level that the pixel needs.
inline constexpr int automatic_level = -1;

/// A scene's trees and shapes in textures, and the image they are drawn to. Needs a current
/// EglContext.
class FrameDrawer {
public:
  /// @throws Error(Output) if the scene or the picture is larger than GL takes
  FrameDrawer(const ViewScene& scene, int width, int height);

  void set_lamp(const Lamp& lamp) const;

  /// Draws and waits until that is done.
  /// @param level of the trees' averages, 0 … 13, or automatic_level; levels beyond a set's own are
  ///        its full level
  /// @return milliseconds
  double draw(int level) const;

  /// RGB of the picture drawn last, top row first.
  std::vector<float> read() const { return m_canvas.read(); }

  /// Bytes of all textures.
  std::size_t texture_bytes() const { return m_texture_bytes; }

private:
  void add(const char* name, Texture texture);
  void add_trees(const ViewScene& scene);
  void add_objects(const ViewScene& scene);
  void set_camera(const renderer::CameraDescription& description, int width, int height) const;

  Program m_program;
  Canvas m_canvas;
  std::vector<Texture> m_textures;
  std::size_t m_texture_bytes = 0;
};

} // namespace haarlight::view
