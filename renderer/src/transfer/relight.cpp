#include <renderer/transfer/relight.h>

namespace haarlight::renderer {

std::unique_ptr<Relighter> make_relighter(const Transfer& transfer, const SceneDescription& scene,
                                          const Variation& variation) {
  switch (variation.varying) {
  case Varying::Light:
    return light_relighter(transfer, scene);
  case Varying::Object:
    return object_relighter(transfer, scene, variation);
  default:
    return reflectance_relighter(transfer, scene, variation);
  }
}

} // namespace haarlight::renderer
