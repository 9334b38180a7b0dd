#pragma once
// Hierarchical sampling: a point of the square is led down quadrant by quadrant, each chosen in
// proportion to its weight, so that well-spread input points stay well spread (Clarberg et al.
// 2005, "Wavelet importance sampling").

#include <wavelet/geometry.h>
#include <wavelet/tree.h>

#include <algorithm>

namespace haarlight::wavelet {

/// A square on the way down, and what is left of the two random numbers there.
struct Descent {
  float u1 = 0; ///< in [0, 1)
  float u2 = 0;
  float x = 0; ///< lower corner of the square
  float y = 0;
  float side = 1;
  float pdf = 1; ///< density of the square's points, per unit square
};

namespace detail {

inline constexpr float below_one = 0x1.fffffep-1F;

/// Chooses between two with weights `first` and `second`, not both 0; rescales u. Returns 1 for the
/// second. Free of branches, which chance would mispredict half of the time.
inline unsigned choose(float& u, float first, float second) {
  const float t = u * (first + second);
  const bool beyond = t >= first;
  const auto chosen = static_cast<float>(beyond);
  u = std::min((t - chosen * first) / (first + chosen * (second - first)), below_one);
  return beyond ? 1U : 0U;
}

inline void enter(Descent& d, unsigned q) {
  d.side *= 0.5F;
  d.x += static_cast<float>(q & 1U) * d.side;
  d.y += static_cast<float>(q >> 1U) * d.side;
}

} // namespace detail

/// One step down, but for the pdf. @param w weights ≥ 0 of the quadrants q = qx + 2 qy, not all 0.
/// @return q
inline unsigned steer(Descent& d, Float4 w) {
  const float columns[2][2] = {{w[0], w[2]}, {w[1], w[3]}};
  const unsigned qx = detail::choose(d.u1, w[0] + w[2], w[1] + w[3]);
  const unsigned qy = detail::choose(d.u2, columns[qx][0], columns[qx][1]);
  const unsigned q = qx + 2 * qy;
  detail::enter(d, q);
  return q;
}

/// The step of steer() towards (u, v) of the unit square, in the descent's square.
inline unsigned steer_to(Descent& d, float u, float v) {
  const float half = 0.5F * d.side;
  const unsigned q = (u >= d.x + half ? 1U : 0U) + (v >= d.y + half ? 2U : 0U);
  detail::enter(d, q);
  return q;
}

/// Factor that the choice of quadrant q puts on a pdf.
inline float quadrant_density(Float4 w, unsigned q) {
  return 4.0F * w[q] / ((w[0] + w[2]) + (w[1] + w[3]));
}

/// The point where a finished descent ends.
inline Vec2 end_point(const Descent& d) { return {d.x + d.u1 * d.side, d.y + d.u2 * d.side}; }

/// A tree, or what lies under one of its squares, as a density: luminance-like weights of colours.
struct TreeDensity {
  const TreeView* tree = nullptr;
  std::uint32_t node = no_node; ///< of the square, or no_node: uniform in it
  Float4 mean = {};             ///< average over the square, lanes R, G, B, 0
  Float4 weights = luminance_lanes;

  /// Density over a whole tree.
  static TreeDensity of(const TreeView& view, Float4 colour_weights = luminance_lanes) {
    return {&view, view.root(), to_lanes(view.mean), colour_weights};
  }
};

namespace detail {

/// Share of a square's average that each of its quadrants gets at least: thresholded trees go
/// negative, and what they lost must stay reachable.
inline constexpr float quadrant_floor = 1.0F / 256;

/// Clamped weights of the four quadrants.
inline Float4 quadrant_weights(const std::array<Float4, 4>& children, Float4 weights) {
  Float4 w = {lane_sum(children[0] * weights), lane_sum(children[1] * weights),
              lane_sum(children[2] * weights), lane_sum(children[3] * weights)};
  w = larger(w, Float4{});
  const float floor = quadrant_floor * lane_sum(w) + 1e-30F;
  return larger(w, Float4{floor, floor, floor, floor});
}

template <class Step>
void walk_density(TreeDensity density, Step step) {
  while (density.node != no_node) {
    const auto children = density.tree->details(density.node).children(density.mean);
    const unsigned q = step(quadrant_weights(children, density.weights));
    density.mean = children[q];
    density.node = density.tree->child(density.node, q);
  }
}

} // namespace detail

/// Leads a descent from a square to the end of its tree; d.pdf becomes the pdf per unit square.
inline void descend_tree(Descent& d, const TreeDensity& density) {
  detail::walk_density(density, [&](Float4 w) {
    const unsigned q = steer(d, w);
    d.pdf *= quadrant_density(w, q);
    return q;
  });
}

/// The pdf of descend_tree() at (u, v), which must lie in the descent's square, into d.pdf.
inline void follow_tree(Descent& d, const TreeDensity& density, float u, float v) {
  detail::walk_density(density, [&](Float4 w) {
    const unsigned q = steer_to(d, u, v);
    d.pdf *= quadrant_density(w, q);
    return q;
  });
}

} // namespace haarlight::wavelet
