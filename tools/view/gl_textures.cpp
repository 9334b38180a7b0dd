#include <view/gl_textures.h>

namespace haarlight::view {

void NamedTextures::put(const PackedTexture& packed) {
  for (Named& old : m_textures)
    if (old.name == packed.sampler) {
      old.texture = Texture(packed);
      old.bytes = packed.bytes.size();
      return;
    }
  m_textures.push_back({packed.sampler, Texture(packed), packed.bytes.size()});
}

void NamedTextures::bind(const Program& program) const {
  int unit = 0;
  for (const Named& named : m_textures)
    program.set(named.name, unit++, named.texture);
}

std::size_t NamedTextures::bytes() const {
  std::size_t bytes = 0;
  for (const Named& named : m_textures)
    bytes += named.bytes;
  return bytes;
}

} // namespace haarlight::view
