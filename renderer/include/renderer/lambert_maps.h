#pragma once
// A Lambertian reflectance as the θ_r-only set, so that it samples like any other material.

#include <wavelet/map_set.h>

namespace haarlight::renderer {

/// Maps of albedo/π · max(0, n·ω) in the reflection frame, as brdf::BrdfMaps makes for measured
/// ones.
class LambertMaps : public wavelet::MapSource {
public:
  /// @param albedo per channel, in [0, 1]
  /// @param size   pixels along a side, a power of two; @param theta cells of θ_r
  explicit LambertMaps(const Rgb& albedo, int size = 64, int theta = 64);

  const wavelet::SetInfo& info() const override { return m_info; }
  wavelet::Map make(int column, int row) const override;

private:
  Rgb m_albedo;
  wavelet::SetInfo m_info;
};

} // namespace haarlight::renderer
