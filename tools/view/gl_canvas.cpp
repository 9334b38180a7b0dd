#include <view/gl_objects.h>

#include <wavelet/base/error.h>

#include <epoxy/gl.h>

#include <stdexcept>

namespace haarlight::view {
namespace {

/// Before any texture is made, so that it is the picture that is said to be too large.
int checked_side(int side) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (side > most)
    throw_output_error("GL",
                       "a picture can have " + std::to_string(most) + " pixels a side at most");
  return side;
}

} // namespace

Cover::Cover() { glGenVertexArrays(1, &m_vertices); }

Cover::~Cover() { glDeleteVertexArrays(1, &m_vertices); }

void Cover::draw_to(unsigned framebuffer, const Area& area) const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glBindVertexArray(m_vertices);
  glViewport(area.x, area.y, area.width, area.height);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

Canvas::Canvas(int width, int height)
    : m_width(checked_side(width)), m_height(checked_side(height)),
      m_texture({"picture", Texel::Rgba32F, width, height, 0, false, {}}) {
  glGenFramebuffers(1, &m_frame);
  glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, m_texture.id(), 0);
}

Canvas::~Canvas() { glDeleteFramebuffers(1, &m_frame); }

void Canvas::draw(const Cover& cover) const {
  cover.draw_to(m_frame, area());
  glFinish();
}

std::vector<float> Canvas::read() const {
  glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
  std::vector<float> rgba(4 * static_cast<std::size_t>(m_width) *
                          static_cast<std::size_t>(m_height));
  glReadPixels(0, 0, m_width, m_height, GL_RGBA, GL_FLOAT, rgba.data());
  if (const GLenum fault = glGetError(); fault != GL_NO_ERROR)
    throw std::runtime_error("GL reports error " + std::to_string(fault));
  return rgba;
}

} // namespace haarlight::view
