#pragma once
// What a picture takes of GL: textures, programs, an image to draw to. All need a current context,
// of OpenGL ES 3.0 or OpenGL 3.3, and are gone with their object.

#include <string>
#include <vector>
#include <view/packed_scene.h>

namespace haarlight::view {

/// A texture, 2D or 3D.
class Texture {
public:
  /// @throws Error(Output) if it is larger than GL takes
  explicit Texture(const PackedTexture& packed);
  ~Texture();
  Texture(Texture&& other) noexcept;
  Texture& operator=(Texture&& other) noexcept;
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  unsigned target() const { return m_target; }
  unsigned id() const { return m_id; }

private:
  unsigned m_target = 0;
  unsigned m_id = 0;
};

/// A linked pair of shaders.
class Program {
public:
  /// The shaders lack their #version, which the context decides. Compilation may only fail by a
  /// fault of the shaders or the driver: std::runtime_error with the driver's words.
  Program(const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const;
  /// Sets a uniform, of 1 to 4 floats or one integer, if the shaders have it. All put the program
  /// into use.
  void set(const std::string& name, const std::vector<float>& values) const;
  void set(const std::string& name, int value) const;
  void set(const std::string& name, const Eigen::Matrix3f& value) const;
  /// Binds a texture to a unit and a sampler to that.
  void set(const std::string& name, int unit, const Texture& texture) const;

private:
  int place(const std::string& name) const;
  unsigned m_id = 0;
};

/// A rectangle of pixels, from the lower left corner as GL counts.
struct Area {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Covers an area of a framebuffer with one triangle, by the program in use.
class Cover {
public:
  Cover();
  ~Cover();
  Cover(const Cover&) = delete;
  Cover& operator=(const Cover&) = delete;

  void draw_to(unsigned framebuffer, const Area& area) const;

private:
  unsigned m_vertices = 0;
};

/// A texture of four floats a pixel that is drawn to.
class Canvas {
public:
  /// @throws Error(Output) if it is larger than GL takes
  Canvas(int width, int height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  Area area() const { return {0, 0, m_width, m_height}; }
  const Texture& texture() const { return m_texture; }

  /// Covers it by the program in use, and waits until that is done.
  void draw(const Cover& cover) const;
  /// RGBA, the row of y = 0 first. @throws std::runtime_error if GL has met an error since it began
  std::vector<float> read() const;

private:
  int m_width;
  int m_height;
  Texture m_texture;
  unsigned m_frame = 0;
};

} // namespace haarlight::view
