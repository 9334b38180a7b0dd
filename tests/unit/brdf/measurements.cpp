// The real measurements, where they are present: see data/README.md of the shared folder.
#include "brdf_test_support.h"

#include <brdf/brdf_maps.h>
#include <brdf/brdf_properties.h>
#include <brdf/tabulate.h>

#include <map>
#include <numbers>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;

namespace {

/// Luminance albedos at θ = 0, 30, 60, 75, 85°, as published with the files.
const std::map<std::string, std::vector<double>> published_albedos = {
    {"pink-felt", {.246, .250, .263, .293, .446}},
    {"red-plastic", {.105, .108, .123, .147, .218}},
    {"violet-acrylic", {.064, .061, .055, .081, .040}},
    {"red-metallic-paint", {.054, .056, .066, .091, .044}},
    {"gold-paint", {.195, .181, .169, .179, .189}},
    {"nickel-noise5", {.210, .190, .192, .178, .062}},
    {"chrome", {.117, .127, .126, .124, .058}}};

void check_albedos(const MeasuredBrdf& brdf, const std::vector<double>& published) {
  const double degrees[] = {0, 30, 60, 75, 85};
  for (std::size_t i = 0; i < published.size(); ++i) {
    const double theta = degrees[i] * std::numbers::pi / 180;
    const Rgb albedo = directional_albedo(brdf, theta, theta);
    CHECK(luminance(albedo) == Approx(published[i]).epsilon(0.01).margin(0.0006));
  }
}

/// Sums of a set's maps against their integrals by quadrature, in a few of its columns.
void check_maps(const MeasuredBrdf& brdf) {
  BrdfMapOptions options;
  options.size = 64;
  const BrdfMaps small(brdf, options);
  options.size = 128;
  const BrdfMaps large(brdf, options);
  for (const int column : {0, 30, 50, 63}) {
    const Rgb truth = *small.integral(column, 0);
    for (const BrdfMaps* maps : {&small, &large}) {
      const Rgb sum =
          (wavelet::map_mean(maps->make(column, 0)) * 4 * std::numbers::pi).cast<float>();
      CHECK(luminance(sum) == Approx(luminance(truth)).epsilon(column == 63 ? 1.5e-2 : 2.5e-3));
    }
  }
}

} // namespace

TEST_CASE("measured albedos and their maps", "[measured][shared-data]") {
  const TemporaryFolder folder;
  for (const std::string& name : measurement_names) {
    const std::string path = unpack_measurement(name, folder);
    INFO(name);
    const MeasuredBrdf brdf(path);
    CHECK(brdf.name() == name + ".binary");
    CHECK(bilateral_asymmetry(brdf) < 0.1);
    check_albedos(brdf, published_albedos.at(name));
    check_maps(brdf);
    std::filesystem::remove(path);
  }
}

TEST_CASE("synthetic tables are valid where real ones are", "[measured][shared-data]") {
  const TemporaryFolder folder;
  const std::string path = unpack_measurement("chrome", folder);
  const MerlTable real = read_merl(path);
  const MerlTable synthetic = tabulate(Ggx());
  int different = 0;
  for (std::size_t i = 0; i < real.plane_size(); ++i)
    different += (real.raw[i] < 0) != (synthetic.raw[i] < 0) ? 1 : 0;
  CHECK(different <= 4);
}
