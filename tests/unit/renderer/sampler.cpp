#include "sampler_checks.h"

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr SamplerKind basic_kinds[] = {SamplerKind::Product, SamplerKind::ProductTable,
                                       SamplerKind::Light, SamplerKind::Brdf, SamplerKind::Mis};

} // namespace

TEST_CASE("the basic samplers with the unbiased estimator agree with brute-force quadrature") {
  // Of 120 that stray by chance alone, 3 or fewer do with probability 0.9995.
  check_unbiased(basic_kinds, 3);
}

TEST_CASE("the basic samplers draw what their pdf says") { check_densities(basic_kinds); }

TEST_CASE("the product's own integral is close to the truth") {
  for (const char* material : {"rough", "glossy"}) {
    const SceneDescription description = fixture().scene(material, "studio");
    const LoadedScene scene(description, {}, SamplerKind::Product, false);
    const auto factory = make_sampler_factory(SamplerKind::Product, scene, {});
    const auto sampler = factory->make(16);
    const probe::Probe source = probe_of(description);
    double truth = 0;
    double product = 0;
    for (const ShadingPoint& point : shading_points()) {
      sampler->prepare(point, scene.materials()[0]);
      truth += quadrature(scene, point, source);
      product += static_cast<double>(luminance(*sampler->unshadowed()));
    }
    CHECK(product == Approx(truth).epsilon(0.03));
  }
}

TEST_CASE("a missing table is reported with the sampler that needs it") {
  SceneDescription description = fixture().scene("rough", "studio");
  description.light.table.clear();
  CHECK_THROWS_WITH(LoadedScene(description, {}, SamplerKind::ProductTable, false),
                    Catch::Contains("\"table\""));
  description = fixture().scene("rough", "studio");
  std::swap(description.materials[0].haar, description.materials[0].table);
  CHECK_THROWS_WITH(LoadedScene(description, {}, SamplerKind::Product, false),
                    Catch::Contains("--roll 1"));
}
