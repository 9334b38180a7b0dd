#pragma once
// Lobes for tests of products: as maps, as trees, and seen from a point.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

namespace haarlight::wavelet {

inline Tree tree_of(const Map& map, double tolerance) {
  CompressOptions options;
  options.threshold.criterion = Criterion::L2;
  options.threshold.tolerance = tolerance;
  options.coefficients = CoefficientType::Float;
  CompressReport report;
  return compress_map(map, options, report);
}

/// A lobe about +z over a dim hemisphere, a little darker for each further entry.
inline Map lobe_map(int size, int entry) {
  Map map(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec3 w =
          square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                                (static_cast<float>(y) + 0.5F) / static_cast<float>(size)));
      const float lobe = 30 * std::exp(40 * (w.z() - 1)) + 0.1F * std::max(0.0F, w.z());
      map.set(x, y, Rgb(1.0F, 0.8F, 0.5F) * lobe / static_cast<float>(1 + entry));
    }
  return map;
}

inline RotatedReflectance reflectance_at(const Pyramid& pyramid, const Vec3& n, const Vec3& wo,
                                         float blend) {
  return {&pyramid, 0, 1, blend, reflection_frame(n, wo)};
}

} // namespace haarlight::wavelet
