#include <renderer/film/film.h>

namespace haarlight::renderer {

std::string validate_film_size(long long width, long long height) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  if (width < 1 || height < 1)
    return "a film of " + size + " pixels has no area";
  if (width > film_pixels_max / height)
    return "a film of " + size + " pixels is too large, " + std::to_string(film_pixels_max) +
           " pixels are the limit";
  return {};
}

} // namespace haarlight::renderer
