#pragma once
// The numbers of an adaptive product: what the quadrants of many squares weigh, worked out side by
// side so that the processor's lanes are full and its waits overlap.

#include <wavelet/adaptive_product.h>

#include <array>
#include <span>

namespace haarlight::wavelet::detail {

/// Products are kept for points whose normal and mirror direction are up to this far away, in
/// radians, and reach that much below the horizon.
inline constexpr float kept_shift = 0.05F;

/// The four quadrants q = qx + 2 qy of a family.
struct Quadrants {
  unsigned visible = 0; ///< bit q: some of it lies above the horizon, or little below
  std::array<std::uint32_t, 4> children; ///< nodes of the light tree, or no_node
  Float4 density = {};                   ///< the product's average weight; 0 below the horizon
  Float4 error = {}; ///< what each leaves of the product's variance if it stays a leaf
  std::array<Float4, 4> light;
  std::array<Float4, 4> reflectance; ///< lanes R, G, B; 0 below the horizon
};

/// Families that are worked on together.
inline constexpr std::size_t family_batch = 16;

/// @param families at most family_batch
/// @param floor    of the reflectance, lanes R, G, B
void weigh_families(const TreeView& light, const RotatedReflectance& reflectance, Float4 floor,
                    std::span<const Family> families, Quadrants* out);

/// Weighs leaves under another reflectance: sets theirs, and what weigh_families() calls density
/// and error.
/// @param leaves at most 4 · family_batch
void weigh_leaves(const RotatedReflectance& reflectance, Float4 floor,
                  std::span<ProductLeaf> leaves, float* density, float* error);

} // namespace haarlight::wavelet::detail
