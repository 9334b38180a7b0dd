#include <view/gl_objects.h>

#include <wavelet/error.h>

#include <epoxy/gl.h>

#include <array>
#include <utility>

namespace haarlight::view {
namespace {

struct Format {
  GLint internal;
  GLenum format;
  GLenum type;
};

Format format_of(Texel texel) {
  constexpr std::array<Format, 4> formats = {{{GL_R32F, GL_RED, GL_FLOAT},
                                              {GL_RGBA32F, GL_RGBA, GL_FLOAT},
                                              {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT},
                                              {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT}}};
  return formats[static_cast<std::size_t>(texel)];
}

void check_side(GLenum limit, int side) {
  GLint most = 0;
  glGetIntegerv(limit, &most);
  if (side > most)
    throw_output_error("GL", "what is to be shown takes a texture of " + std::to_string(side) +
                                 " texels a side; " + std::to_string(most) + " are possible");
}

unsigned make_texture(GLenum target, GLint filter) {
  unsigned id = 0;
  glActiveTexture(GL_TEXTURE15); // the last that every GL has, so that no sampler loses its texture
  glGenTextures(1, &id);
  glBindTexture(target, id);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(target, wrap, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  return id;
}

} // namespace

Texture::Texture(Texel texel, int width, int height, const void* texels) : m_target(GL_TEXTURE_2D) {
  check_side(GL_MAX_TEXTURE_SIZE, width);
  check_side(GL_MAX_TEXTURE_SIZE, height);
  m_id = make_texture(m_target, GL_NEAREST);
  const Format format = format_of(texel);
  glTexImage2D(m_target, 0, format.internal, width, height, 0, format.format, format.type, texels);
}

Texture::Texture(Texel texel, const std::vector<const void*>& levels) : m_target(GL_TEXTURE_2D) {
  const int finest = static_cast<int>(levels.size()) - 1;
  check_side(GL_MAX_TEXTURE_SIZE, 1 << finest);
  m_id = make_texture(m_target, GL_NEAREST);
  glTexParameteri(m_target, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
  const Format format = format_of(texel);
  for (int mip = 0; mip <= finest; ++mip) {
    const int side = 1 << (finest - mip);
    glTexImage2D(m_target, mip, format.internal, side, side, 0, format.format, format.type,
                 levels[static_cast<std::size_t>(mip)]);
  }
}

Texture::Texture(int width, int height, int depth, const std::uint16_t* halves)
    : m_target(GL_TEXTURE_3D) {
  for (const int side : {width, height, depth})
    check_side(GL_MAX_3D_TEXTURE_SIZE, side);
  m_id = make_texture(m_target, GL_LINEAR);
  glTexImage3D(m_target, 0, GL_RGBA16F, width, height, depth, 0, GL_RGBA, GL_HALF_FLOAT, halves);
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

} // namespace haarlight::view
