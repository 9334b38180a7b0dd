#pragma once
// What is seen from a point past the things around it, as products that are built on the fly ask
// for it.

#include <wavelet/square/square_place.h>

#include <span>

namespace haarlight::wavelet {

/// What is known of one square.
struct SquareView {
  float seen = 1; ///< share of it that is seen, in [0, 1]: an estimate, but 0 only where surely
                  ///< nothing is; what lies below the horizon counts neither way
  std::uint64_t occluders = ~std::uint64_t{0}; ///< what may be in its way, in bits that
                                               ///< SquareVisibility alone understands
};

/// The visibility of the light from a point.
class SquareVisibility {
public:
  virtual ~SquareVisibility() = default;

  /// Sets `views` to what is seen of as many squares of the light's frame, of level 3 or more.
  /// @param views on entry, with the occluders of some square around each, or all bits
  virtual void look(std::span<const SquarePlace> squares, std::span<SquareView> views) = 0;
};

} // namespace haarlight::wavelet
