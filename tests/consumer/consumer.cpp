// One call into each installed library.
#include <brdf/analytic.h>
#include <probe/mapping.h>
#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>
#include <wavelet/square/sphere_map.h>

#include <cmath>
#include <cstdio>

int main() {
  const haarlight::Vec3 up(0, 0, 1);
  const float centre = haarlight::wavelet::sphere_to_square(up).x();
  const haarlight::Rgb value = haarlight::brdf::evaluate(haarlight::brdf::Ggx{}, up, up);
  try {
    haarlight::renderer::load_scene("missing.json");
  } catch (const haarlight::Error& error) {
    std::printf("%g %g %s\n", static_cast<double>(centre), static_cast<double>(value[0]),
                error.what());
    return std::abs(centre - 0.5F) < 1e-6F && value[0] > 0 ? 0 : 1;
  }
  return 1;
}
