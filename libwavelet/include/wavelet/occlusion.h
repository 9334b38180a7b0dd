#pragma once
// What is in the light's way, as products that are built on the fly ask for it.

#include <wavelet/square_place.h>

#include <span>

namespace haarlight::wavelet {

/// What stands between a point and the light.
class Occlusion {
public:
  virtual ~Occlusion() = default;

  /// Sets each of `seen` to the share of a square of the light's frame that is seen from the point,
  /// in [0, 1]: an estimate, but 0 only where surely nothing is seen. What lies below the horizon
  /// counts neither way.
  /// @param squares of level 3 or more; as many as `seen`
  virtual void find(std::span<const SquarePlace> squares, std::span<float> seen) = 0;
};

} // namespace haarlight::wavelet
