#include <view/gl_objects.h>

#include <epoxy/gl.h>

#include <stdexcept>

namespace haarlight::view {
namespace {

unsigned compile(GLenum kind, const std::string& text) {
  const unsigned shader = glCreateShader(kind);
  const char* const sources[] = {
      epoxy_is_desktop_gl() ? "#version 330 core\n" : "#version 300 es\n", text.c_str()};
  glShaderSource(shader, 2, sources, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE)
    return shader;
  std::string log(2000, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  throw std::runtime_error("a shader does not compile: " + log);
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

int Program::place(const std::string& name) const {
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
  setter(place(name), 1, values.data());
}

void Program::set(const std::string& name, int value) const {
  use();
  glUniform1i(place(name), value);
}

void Program::set(const std::string& name, const Eigen::Matrix3f& value) const {
  use();
  glUniformMatrix3fv(place(name), 1, GL_FALSE, value.data());
}

void Program::set(const std::string& name, int unit, const Texture& texture) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(texture.target(), texture.id());
  set(name, unit);
}

} // namespace haarlight::view
