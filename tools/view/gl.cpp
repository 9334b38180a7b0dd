#include <view/gl.h>

#include <wavelet/base/error.h>

#define EGL_NO_X11 // the macros of Xlib.h
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <stdexcept>
#include <utility>

#include <dlfcn.h>

namespace haarlight::view {
namespace {

[[noreturn]] void throw_no_egl(const std::string& reason) {
  throw_output_error(
      "EGL", reason + " (Debian: libegl1, libgles2 and libgl1-mesa-dri draw without a graphics "
                      "card)");
}

/// libepoxy ends the process where the library of the calls is missing, so look for it first.
bool has_gles_library() {
  void* const library = dlopen("libGLESv2.so.2", RTLD_LAZY | RTLD_LOCAL);
  if (library != nullptr)
    dlclose(library);
  return library != nullptr;
}

EGLDisplay surfaceless_display() {
  if (!epoxy_has_egl())
    throw_no_egl("is not installed");
  if (!has_gles_library())
    throw_no_egl("is installed, but libGLESv2.so.2 is not");
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    throw_no_egl("has no surfaceless platform");
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
}

struct TexelLayout {
  GLint internal;
  GLenum format;
  GLenum type;
  std::size_t bytes;
};

TexelLayout layout_of(TexelFormat format) {
  constexpr std::array layouts =
      std::to_array<TexelLayout>({{GL_R32F, GL_RED, GL_FLOAT, 4},
                                  {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
                                  {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8},
                                  {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
                                  {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16}});
  static_assert(layouts.size() == texel_format_count);
  return layouts[static_cast<std::size_t>(format)];
}

int size_limit(GLenum name) {
  GLint limit = 0;
  glGetIntegerv(name, &limit);
  return limit;
}

void check_texture_size(const TextureData& data) {
  const int limit = size_limit(data.depth > 0 ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE);
  for (const int side : {data.width, data.height, data.depth})
    if (side > limit)
      throw_output_error("GL", "the scene needs a texture with a side of " + std::to_string(side) +
                                   " texels; the limit is " + std::to_string(limit));
}

/// Called before the texture is made, so that the message names the picture.
int checked_picture_side(int side) {
  const int limit = size_limit(GL_MAX_TEXTURE_SIZE);
  if (side > limit)
    throw_output_error("GL", "a picture can have " + std::to_string(limit) +
                                 " pixels along a side at most");
  return side;
}

void upload(const TextureData& data) {
  const TexelLayout layout = layout_of(data.format);
  const std::byte* bytes = data.bytes.empty() ? nullptr : data.bytes.data();
  if (data.depth > 0) {
    glTexImage3D(GL_TEXTURE_3D, 0, layout.internal, data.width, data.height, data.depth, 0,
                 layout.format, layout.type, bytes);
    return;
  }
  for (int mip = 0; mip == 0 || (data.mips && data.width >> mip > 0); ++mip) {
    const int width = data.width >> mip;
    const int height = data.height >> mip;
    glTexImage2D(GL_TEXTURE_2D, mip, layout.internal, width, height, 0, layout.format, layout.type,
                 bytes);
    if (bytes != nullptr)
      bytes += layout.bytes * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
}

unsigned compile(GLenum kind, const std::string& text) {
  const unsigned shader = glCreateShader(kind);
  const char* const sources[] = {
      epoxy_is_desktop_gl() ? "#version 330 core\n" : "#version 300 es\n", text.c_str()};
  glShaderSource(shader, 2, sources, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE)
    return shader;
  std::string log(2000, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  throw std::runtime_error("a shader does not compile: " + log);
}

} // namespace

struct EglContext::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (display == EGL_NO_DISPLAY)
      return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT)
      eglDestroyContext(display, context);
    eglTerminate(display);
  }
};

EglContext::EglContext() : m_handles(std::make_unique<Handles>()) {
  auto& [display, context] = *m_handles;
  display = surfaceless_display();
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE)
    throw_no_egl("finds no device");
  const EGLint attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                               EGL_OPENGL_ES3_BIT, EGL_NONE};
  const EGLint version[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglBindAPI(EGL_OPENGL_ES_API) == EGL_FALSE ||
      eglChooseConfig(display, attributes, &config, 1, &count) == EGL_FALSE || count == 0)
    throw_no_egl("has no OpenGL ES 3.0");
  context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  if (context == EGL_NO_CONTEXT ||
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE)
    throw_no_egl("cannot make a context of OpenGL ES 3.0");
  if (!epoxy_has_gl_extension("GL_EXT_color_buffer_float"))
    throw_no_egl("cannot render to float textures (GL_EXT_color_buffer_float)");
}

EglContext::~EglContext() = default;

std::string renderer_name() { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

Texture::Texture(const TextureData& data)
    : m_target(data.depth > 0 ? GL_TEXTURE_3D : GL_TEXTURE_2D) {
  check_texture_size(data);
  const GLint filter = data.depth > 0 ? GL_LINEAR : GL_NEAREST;
  glActiveTexture(GL_TEXTURE15); // the last unit that every GL has; TextureSet leaves it free
  glGenTextures(1, &m_id);
  glBindTexture(m_target, m_id);
  glTexParameteri(m_target, GL_TEXTURE_MIN_FILTER, data.mips ? GL_NEAREST_MIPMAP_NEAREST : filter);
  glTexParameteri(m_target, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(m_target, wrap, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  upload(data);
}

Texture::~Texture() {
  if (m_id != 0)
    glDeleteTextures(1, &m_id);
}

Texture::Texture(Texture&& other) noexcept
    : m_target(other.m_target), m_id(std::exchange(other.m_id, 0)) {}

Texture& Texture::operator=(Texture&& other) noexcept {
  std::swap(m_target, other.m_target);
  std::swap(m_id, other.m_id);
  return *this;
}

Program::Program(const std::string& vertex, const std::string& fragment) : m_id(glCreateProgram()) {
  for (const unsigned shader :
       {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(m_id, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(m_id);
  GLint linked = GL_FALSE;
  glGetProgramiv(m_id, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE)
    throw std::runtime_error("the shaders do not link");
}

Program::~Program() { glDeleteProgram(m_id); }

void Program::use() const { glUseProgram(m_id); }

int Program::location(const std::string& name) const {
  return glGetUniformLocation(m_id, name.c_str());
}

void Program::set(const std::string& name, const std::vector<float>& values) const {
  use();
  const auto setter = [&] {
    switch (values.size()) {
    case 1:
      return glUniform1fv;
    case 2:
      return glUniform2fv;
    case 3:
      return glUniform3fv;
    default:
      return glUniform4fv;
    }
  }();
  setter(location(name), 1, values.data());
}

void Program::set(const std::string& name, int value) const {
  use();
  glUniform1i(location(name), value);
}

void Program::set(const std::string& name, const Eigen::Matrix3f& value) const {
  use();
  glUniformMatrix3fv(location(name), 1, GL_FALSE, value.data());
}

void Program::set(const std::string& name, int unit, const Texture& texture) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(texture.target(), texture.id());
  set(name, unit);
}

void TextureSet::put(const TextureData& data) {
  for (Named& old : m_textures)
    if (old.name == data.sampler) {
      old.texture = Texture(data);
      old.bytes = data.bytes.size();
      return;
    }
  m_textures.push_back({data.sampler, Texture(data), data.bytes.size()});
}

void TextureSet::bind(const Program& program) const {
  int unit = 0;
  for (const Named& named : m_textures)
    program.set(named.name, unit++, named.texture);
}

std::size_t TextureSet::bytes() const {
  std::size_t bytes = 0;
  for (const Named& named : m_textures)
    bytes += named.bytes;
  return bytes;
}

FullScreenTriangle::FullScreenTriangle() { glGenVertexArrays(1, &m_vertices); }

FullScreenTriangle::~FullScreenTriangle() { glDeleteVertexArrays(1, &m_vertices); }

void FullScreenTriangle::draw_to(unsigned framebuffer, const Viewport& viewport) const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glBindVertexArray(m_vertices);
  glViewport(viewport.x, viewport.y, viewport.width, viewport.height);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

RenderTarget::RenderTarget(int width, int height)
    : m_width(checked_picture_side(width)), m_height(checked_picture_side(height)),
      m_texture({"picture", TexelFormat::Rgba32F, width, height, 0, false, {}}) {
  glGenFramebuffers(1, &m_framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, m_framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, m_texture.id(), 0);
}

RenderTarget::~RenderTarget() { glDeleteFramebuffers(1, &m_framebuffer); }

void RenderTarget::draw(const FullScreenTriangle& triangle) const {
  triangle.draw_to(m_framebuffer, {0, 0, m_width, m_height});
  glFinish();
}

std::vector<float> RenderTarget::read() const {
  glBindFramebuffer(GL_FRAMEBUFFER, m_framebuffer);
  std::vector<float> rgba(4 * static_cast<std::size_t>(m_width) *
                          static_cast<std::size_t>(m_height));
  glReadPixels(0, 0, m_width, m_height, GL_RGBA, GL_FLOAT, rgba.data());
  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    throw std::runtime_error("GL reports error " + std::to_string(error));
  return rgba;
}

} // namespace haarlight::view
