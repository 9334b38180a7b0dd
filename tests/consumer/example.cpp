// Reads the light and the reflectance of two .haar files and samples their product at one shading
// point.
#include <wavelet/base/error.h>
#include <wavelet/file/tree_set.h>
#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/sphere_map.h>

#include <cstdio>
#include <vector>

using namespace haarlight;

int main(int argc, char** argv) try {
  if (argc != 3)
    return 2;
  const wavelet::TreeSet light(argv[1]); // radiance by direction, world frame
  const wavelet::TreeSet brdf(
      argv[2]); // f_r cos θ_i, one tree for each θ_r, about the mirror direction

  // The average radiance over a sixteenth of the sphere: square (1, 2) of level 2.
  const Rgb average = light.tree(0, 0).average(2, 1, 2);
  std::printf("average %g %g %g\n", average[0], average[1], average[2]);

  // The product of the light and the reflectance of the entry θ_r ≈ 0, at a point seen along its
  // normal.
  std::vector<wavelet::TreeView> entries;
  for (int i = 0; i < brdf.info().columns; ++i)
    entries.push_back(brdf.tree(i, 0));
  const wavelet::Pyramid reflectance(entries);
  wavelet::AdaptiveProduct product(light.tree(0, 0));
  const Vec3 normal(0, 1, 0);
  const wavelet::ProductTree& tree =
      product.build({&reflectance, 0, 0, 0, reflection_frame(normal, normal)}, {});
  const Rgb reflected = tree.integral() * wavelet::sphere_area;
  std::printf("reflected radiance %g %g %g\n", reflected[0], reflected[1], reflected[2]);

  const wavelet::Descent sample = tree.sample(0.3F, 0.7F);
  const Vec3 direction = wavelet::square_to_sphere(wavelet::end_point(sample));
  std::printf("direction %g %g %g, pdf %g per steradian\n", direction.x(), direction.y(),
              direction.z(), sample.pdf / wavelet::sphere_area);
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
