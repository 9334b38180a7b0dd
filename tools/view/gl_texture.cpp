#include <view/gl_objects.h>

#include <wavelet/base/error.h>

#include <epoxy/gl.h>

#include <array>
#include <utility>

namespace haarlight::view {
namespace {

struct Format {
  GLint internal;
  GLenum format;
  GLenum type;
  std::size_t bytes;
};

Format format_of(Texel texel) {
  constexpr std::array<Format, 5> formats = {{{GL_R32F, GL_RED, GL_FLOAT, 4},
                                              {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
                                              {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8},
                                              {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
                                              {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16}}};
  return formats[static_cast<std::size_t>(texel)];
}

void check_side(GLenum limit, int side) {
  GLint most = 0;
  glGetIntegerv(limit, &most);
  if (side > most)
    throw_output_error("GL", "what is to be shown takes a texture of " + std::to_string(side) +
                                 " texels a side; " + std::to_string(most) + " are possible");
}

unsigned make_texture(GLenum target, const PackedTexture& packed) {
  const GLint filter = packed.depth > 0 ? GL_LINEAR : GL_NEAREST;
  unsigned id = 0;
  glActiveTexture(GL_TEXTURE15); // the last that every GL has, so that no sampler loses its texture
  glGenTextures(1, &id);
  glBindTexture(target, id);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, packed.mips ? GL_NEAREST_MIPMAP_NEAREST : filter);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(target, wrap, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  return id;
}

const std::byte* bytes_of(const PackedTexture& packed) {
  return packed.bytes.empty() ? nullptr : packed.bytes.data();
}

void fill_3d(const PackedTexture& packed) {
  const Format format = format_of(packed.texel);
  glTexImage3D(GL_TEXTURE_3D, 0, format.internal, packed.width, packed.height, packed.depth, 0,
               format.format, format.type, bytes_of(packed));
}

void fill_2d(const PackedTexture& packed) {
  const Format format = format_of(packed.texel);
  const std::byte* bytes = bytes_of(packed);
  for (int mip = 0; mip == 0 || (packed.mips && packed.width >> mip > 0); ++mip) {
    const int width = packed.width >> mip;
    const int height = packed.height >> mip;
    glTexImage2D(GL_TEXTURE_2D, mip, format.internal, width, height, 0, format.format, format.type,
                 bytes);
    if (bytes != nullptr)
      bytes += format.bytes * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
}

} // namespace

Texture::Texture(const PackedTexture& packed)
    : m_target(packed.depth > 0 ? GL_TEXTURE_3D : GL_TEXTURE_2D) {
  const GLenum limit = packed.depth > 0 ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE;
  for (const int side : {packed.width, packed.height, packed.depth})
    check_side(limit, side);
  m_id = make_texture(m_target, packed);
  if (packed.depth > 0)
    fill_3d(packed);
  else
    fill_2d(packed);
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
