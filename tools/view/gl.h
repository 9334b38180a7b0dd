#pragma once
// The parts of OpenGL that the viewer uses: textures, programs, render targets, and a context
// without a window. All objects but the context need a current context of OpenGL ES 3.0 or
// OpenGL 3.3 for their whole life.

#include <view/packing.h>

#include <memory>
#include <string>
#include <vector>

namespace haarlight::view {

/// An OpenGL ES 3.0 context on EGL's surfaceless platform (Mesa: the machine's GPU, or llvmpipe
/// without one), current to the thread that made it. One per process at a time.
class EglContext {
public:
  /// @throws Error(Output) that names what is missing, if there is no EGL, no surfaceless platform,
  ///         or no OpenGL ES 3.0 that renders to float textures
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

private:
  struct Handles;
  std::unique_ptr<Handles> m_handles;
};

/// GL_RENDERER of the current context: the name of the device or software renderer.
std::string renderer_name();

/// A 2D or 3D texture.
class Texture {
public:
  /// @throws Error(Output) if it exceeds the size limits of this GL
  explicit Texture(const TextureData& data);
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

/// A linked vertex and fragment shader.
class Program {
public:
  /// The shaders lack their #version line, which depends on the context.
  /// @throws std::runtime_error with the driver's log if they do not compile or link, which only a
  ///         fault of the shaders or the driver can cause
  Program(const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const;
  /// Sets a uniform of 1 to 4 floats, one integer or one matrix; ignored if the shaders have none
  /// of this name. All overloads make the program current.
  void set(const std::string& name, const std::vector<float>& values) const;
  void set(const std::string& name, int value) const;
  void set(const std::string& name, const Eigen::Matrix3f& value) const;
  /// Binds a texture to a unit and a sampler to that unit.
  void set(const std::string& name, int unit, const Texture& texture) const;

private:
  int location(const std::string& name) const;
  unsigned m_id = 0;
};

/// Textures by the names of their samplers, at most 15.
class TextureSet {
public:
  /// Adds a texture, or replaces the one of the same name.
  /// @throws Error(Output) if it exceeds the size limits of this GL
  void put(const TextureData& data);

  /// Binds all textures to the samplers of a program.
  void bind(const Program& program) const;

  std::size_t bytes() const;

private:
  struct Named {
    std::string name;
    Texture texture;
    std::size_t bytes;
  };
  std::vector<Named> m_textures;
};

/// A rectangle of pixels; the origin is the lower left corner, as in GL.
struct Viewport {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// A triangle that covers a whole viewport.
class FullScreenTriangle {
public:
  FullScreenTriangle();
  ~FullScreenTriangle();
  FullScreenTriangle(const FullScreenTriangle&) = delete;
  FullScreenTriangle& operator=(const FullScreenTriangle&) = delete;

  /// Draws it with the current program. @param framebuffer GL's name of it; 0 is the window
  void draw_to(unsigned framebuffer, const Viewport& viewport) const;

private:
  unsigned m_vertices = 0;
};

/// An RGBA32F texture that is rendered to.
class RenderTarget {
public:
  /// @throws Error(Output) if it exceeds the size limits of this GL
  RenderTarget(int width, int height);
  ~RenderTarget();
  RenderTarget(const RenderTarget&) = delete;
  RenderTarget& operator=(const RenderTarget&) = delete;

  int width() const { return m_width; }
  int height() const { return m_height; }
  const Texture& texture() const { return m_texture; }

  /// Covers it with the current program and waits until the GPU is done.
  void draw(const FullScreenTriangle& triangle) const;
  /// RGBA, the row of y = 0 first. @throws std::runtime_error if GL has recorded an error
  std::vector<float> read() const;

private:
  int m_width;
  int m_height;
  Texture m_texture;
  unsigned m_framebuffer = 0;
};

} // namespace haarlight::view
