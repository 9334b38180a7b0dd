#pragma once
// The textures that a picture is drawn from.

#include <view/gl_objects.h>

#include <string>
#include <vector>

namespace haarlight::view {

/// Textures by the names of their samplers, at most 15.
class NamedTextures {
public:
  /// Adds a texture, or replaces the one of its name. @throws Error(Output) if it is larger than GL
  /// takes
  void put(const PackedTexture& packed);

  /// Binds all of them to a program's samplers.
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

} // namespace haarlight::view
