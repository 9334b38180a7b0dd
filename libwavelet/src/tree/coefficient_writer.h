#pragma once
// How differences become a tree's stored coefficients.

#include <wavelet/tree/tree.h>

namespace haarlight::wavelet {

/// Stored halves stay below it, which leaves room below the half's 65504.
inline constexpr float largest_stored_half = 32768;
/// Magnitudes up to this one are rounded to zero.
inline constexpr float smallest_stored_half = 0x1p-25F;

/// A power of two that brings the largest difference just under what a half can hold; 1 for floats.
float coefficient_scale(CoefficientType type, float largest_difference);

/// Appends nodes' coefficients to a tree whose channels, type and scale are set.
class CoefficientWriter {
public:
  explicit CoefficientWriter(Tree& tree) : m_tree(tree) {}

  void append(const Details& details);

  /// Pads the array, so that lanes may be loaded from its end.
  void finish();

private:
  void append_value(float value);

  Tree& m_tree;
};

} // namespace haarlight::wavelet
