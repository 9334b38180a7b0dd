#include <view/gl_objects.h>

#include <wavelet/error.h>

#include <epoxy/gl.h>

#include <stdexcept>

namespace haarlight::view {
namespace {

unsigned compile(GLenum kind, const std::string& text) {
  const unsigned shader = glCreateShader(kind);
  const char* const source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE)
    return shader;
  std::string log(2000, '\0');
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw std::runtime_error("a shader does not compile: " + std::string(log.c_str()));
}

} // namespace

Program::Program(const std::string& vertex, const std::string& fragment) : m_id(glCreateProgram()) {
  for (const unsigned shader :
       {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(m_id, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(m_id);
  GLint good = GL_FALSE;
  glGetProgramiv(m_id, GL_LINK_STATUS, &good);
  if (good != GL_TRUE)
    throw std::runtime_error("the shaders do not link");
}

Program::~Program() { glDeleteProgram(m_id); }

void Program::use() const { glUseProgram(m_id); }

int Program::place(const char* name) const { return glGetUniformLocation(m_id, name); }

void Program::set(const char* name, const std::vector<float>& values) const {
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
  setter(place(name), 1, values.data());
}

void Program::set(const char* name, int value) const { glUniform1i(place(name), value); }

void Program::set(const char* name, int unit, const Texture& texture) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(texture.target(), texture.id());
  set(name, unit);
}

Canvas::Canvas(int width, int height) : m_width(width), m_height(height) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
  if (width > most || height > most)
    throw_output_error("GL",
                       "a picture can have " + std::to_string(most) + " pixels a side at most");
  glGenRenderbuffers(1, &m_buffer);
  glBindRenderbuffer(GL_RENDERBUFFER, m_buffer);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, width, height);
  glGenFramebuffers(1, &m_frame);
  glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, m_buffer);
  glGenVertexArrays(1, &m_vertices);
}

Canvas::~Canvas() {
  glDeleteVertexArrays(1, &m_vertices);
  glDeleteFramebuffers(1, &m_frame);
  glDeleteRenderbuffers(1, &m_buffer);
}

void Canvas::draw() const {
  glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
  glBindVertexArray(m_vertices);
  glViewport(0, 0, m_width, m_height);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glFinish();
}

std::vector<float> Canvas::read() const {
  const std::size_t pixels = static_cast<std::size_t>(m_width) * static_cast<std::size_t>(m_height);
  std::vector<float> rgba(4 * pixels);
  glReadPixels(0, 0, m_width, m_height, GL_RGBA, GL_FLOAT, rgba.data());
  if (const GLenum fault = glGetError(); fault != GL_NO_ERROR)
    throw std::runtime_error("GL reports error " + std::to_string(fault));
  std::vector<float> rgb(3 * pixels);
  for (std::size_t i = 0; i < rgb.size(); ++i)
    rgb[i] = rgba[i / 3 * 4 + i % 3];
  return rgb;
}

} // namespace haarlight::view
