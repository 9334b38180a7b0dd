#pragma once
// A Lambertian reflectance as a set of maps, so that it samples like any other material.

#include <wavelet/tree/map_set.h>

namespace haarlight::renderer {

/// Maps of albedo/π · max(0, n·ω) in the reflection frame, as brdf::BrdfMaps makes for measured
/// ones.
class LambertMaps : public wavelet::MapSource {
public:
  /// @param albedo per channel, in [0, 1]
  /// @param size   pixels along a side, a power of two
  /// @param theta  cells of θ_r
  /// @param rolls  cells of φ over the full circle, all stored; 1 = φ is 0
  explicit LambertMaps(const Rgb& albedo, int size = 64, int theta = 64, int rolls = 1);

  const wavelet::SetInfo& info() const override { return m_info; }
  wavelet::Map make(int column, int row) const override;

private:
  Rgb m_albedo;
  wavelet::SetInfo m_info;
};

} // namespace haarlight::renderer
