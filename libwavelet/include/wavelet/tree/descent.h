#pragma once
// Hierarchical sample warping: a point descends quadrant by quadrant, each chosen in proportion to
// its weight, so that stratified input points stay stratified (Clarberg et al. 2005, "Wavelet
// importance sampling").

#include <wavelet/base/geometry.h>
#include <wavelet/tree/tree.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace haarlight::wavelet {

/// 1 + x (s − ½) + y (t − ½) at (s, t) ∈ [0, 1]² of a square, |x| + |y| < 2: a linear function
/// over its mean.
struct Slope {
  float x = 0;
  float y = 0;

  float at(float s, float t) const { return 1 + x * (s - 0.5F) + y * (t - 0.5F); }

  /// Means over the quadrants q = qx + 2 qy.
  Float4 quadrants() const {
    const float a = 0.25F * x;
    const float b = 0.25F * y;
    return Float4{1 - a - b, 1 + a - b, 1 - a + b, 1 + a + b};
  }

  /// The same function over one quadrant. @param mean quadrants()[q]
  Slope in_quadrant(float mean) const { return {0.5F * x / mean, 0.5F * y / mean}; }

  /// Nearly constant: it changes by less than 1/64, a relative variance of 1/50000.
  bool is_flat() const { return std::abs(x) + std::abs(y) < 1.0F / 64; }
};

namespace detail {

inline constexpr float below_one = 0x1.fffffep-1F;

/// Turns u, uniform in [0, 1), into s of density 1 + slope (s − ½).
inline float warp_linearly(float u, float slope) {
  const float start = 1 - 0.5F * slope;
  const float root = std::sqrt(std::max(start * start + 2 * slope * u, 0.0F));
  return std::min(2 * u / (start + root), below_one);
}

} // namespace detail

/// Turns a uniform point of [0, 1)² into one of the slope's density. @return that density
inline float warp(const Slope& slope, float& s, float& t) {
  s = detail::warp_linearly(s, slope.x);
  const float mean = 1 + slope.x * (s - 0.5F);
  t = detail::warp_linearly(t, slope.y / mean);
  return mean + slope.y * (t - 0.5F);
}

/// The state of a descent: a square, and the rescaled random numbers in it.
struct Descent {
  float u1 = 0; ///< in [0, 1)
  float u2 = 0;
  float x = 0; ///< lower corner of the square
  float y = 0;
  float side = 1;
  float pdf = 1; ///< density of the square's points, per unit square
};

namespace detail {

/// Chooses between two with weights `first` and `second`, not both 0; rescales u. Returns 1 for the
/// second. Never chooses a weight of 0, even with rounding errors. Branchless: a branch would be
/// mispredicted half of the time.
inline unsigned choose(float& u, float first, float second) {
  const float t = u * (first + second);
  const bool beyond = (t >= first) & (second > 0);
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

namespace detail {

/// A power of two by which weights of this mean are multiplied so that neither they nor their sums
/// leave the range of float: 1 unless they are extreme, since densities depend on ratios alone.
inline float density_scale(float mean) {
  constexpr int most = 60;   // details and sums of a tree exceed its mean by less than another 2^60
  constexpr int limit = 100; // leaves room for the values that the scale is multiplied by
  if (!(mean > 0))
    return 1;
  if (!std::isfinite(mean))
    return std::ldexp(1.0F, -limit);
  const int exponent = std::ilogb(mean);
  return std::abs(exponent) <= most ? 1.0F : std::ldexp(1.0F, std::clamp(-exponent, -limit, limit));
}

} // namespace detail

/// A tree, or its part under one square, as a density: weights of colours, such as luminance.
struct TreeDensity {
  const TreeView* tree = nullptr;
  std::uint32_t node = no_node; ///< of the square, or no_node: uniform in it
  float mean = 0;               ///< weighted average over the square
  Float4 weights = luminance_lanes;
  Slope slope = {}; ///< factor of the tree's density over the square

  /// Density over a whole tree, which must outlive it.
  static TreeDensity of(const TreeView& tree, Float4 weights = luminance_lanes) {
    const Float4 mean = to_lanes(tree.mean);
    const Float4 scaled = weights * detail::density_scale(lane_sum(mean * weights));
    return {&tree, tree.root(), lane_sum(mean * scaled), scaled, {}};
  }
};

namespace detail {

/// Fraction of a square's average that each of its quadrants gets at least. Thresholded trees have
/// negative averages where the function is positive, which must keep a density above 0.
inline constexpr float quadrant_floor = 1.0F / 256;

/// Weighted averages over the four quadrants of a node's square.
inline Float4 quadrant_means(const Details& details, const TreeDensity& density) {
  const Float4 d = lane_sums(details.d1 * density.weights, details.d2 * density.weights,
                             details.d3 * density.weights);
  const Float4 left = {d[0], -d[0], d[0], -d[0]};
  const Float4 skew = {d[1] + d[2], d[1] - d[2], -d[1] - d[2], d[2] - d[1]};
  return (left + density.mean) + skew;
}

/// Clamped weights of the four quadrants.
inline Float4 quadrant_weights(Float4 means) {
  const Float4 positive = larger(means, Float4{});
  return larger(positive, Float4{} + (quadrant_floor * lane_sum(positive) + 1e-30F));
}

/// One step from a node to the quadrant that `choose` picks by the quadrants' weights.
template <class Choose>
void step_down(TreeDensity& density, Descent& d, Choose choose) {
  const Float4 means = quadrant_means(density.tree->details(density.node), density);
  const Float4 slopes = density.slope.quadrants();
  const Float4 w = quadrant_weights(means) * slopes;
  const unsigned q = choose(w);
  d.pdf *= quadrant_density(w, q);
  density.slope = density.slope.in_quadrant(slopes[q]);
  density.mean = means[q];
  density.node = density.tree->child_of_existing(density.node, q);
}

/// Spreads a descent over the square where its tree ended.
inline void spread(const TreeDensity& density, Descent& d) {
  if (!density.slope.is_flat())
    d.pdf *= warp(density.slope, d.u1, d.u2);
}

/// The pdf of spread() at (u, v).
inline void follow_spread(const TreeDensity& density, float u, float v, Descent& d) {
  if (!density.slope.is_flat())
    d.pdf *= density.slope.at((u - d.x) / d.side, (v - d.y) / d.side);
}

} // namespace detail

/// Continues a descent from a square to the end of its tree; d.pdf becomes the pdf per unit square.
inline void descend_tree(TreeDensity density, Descent& d) {
  while (density.node != no_node)
    detail::step_down(density, d, [&](Float4 w) { return steer(d, w); });
  detail::spread(density, d);
}

/// The pdf of descend_tree() at (u, v), which must lie in the descent's square, into d.pdf.
inline void follow_tree(TreeDensity density, float u, float v, Descent& d) {
  while (density.node != no_node)
    detail::step_down(density, d, [&](Float4 /*w*/) { return steer_to(d, u, v); });
  detail::follow_spread(density, u, v, d);
}

/// descend_tree() for many at once: their steps alternate, which hides memory latency.
/// @param densities as many as descents; used up
void descend_tree(std::span<TreeDensity> densities, std::span<Descent> descents);

/// follow_tree() for many at once. @param points as many as the others
void follow_tree(std::span<TreeDensity> densities, std::span<const Vec2> points,
                 std::span<Descent> descents);

} // namespace haarlight::wavelet
