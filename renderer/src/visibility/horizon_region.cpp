#include "visibility/horizon_region.h"

#include <algorithm>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::Square;

namespace {

/// Squares of this level are small enough for Gauss quadrature of n·ω.
constexpr int smooth_level = 6;
/// How often squares that the horizon crosses are split for it.
constexpr int horizon_refinements = 2;

/// max(0, n·ω) at the 2 × 2 Gauss points, averaged.
float gauss_cosine(const Vec3& n, const Square& square) {
  constexpr float low = 0.21132487F;
  constexpr float high = 1 - low;
  const float side = power_of_two(-square.level);
  const Float4 u = (static_cast<float>(square.column) + Float4{low, high, low, high}) * side;
  const Float4 v = (static_cast<float>(square.row) + Float4{low, low, high, high}) * side;
  Float4 x;
  Float4 y;
  Float4 z;
  wavelet::square_to_sphere(u, v, x, y, z);
  return 0.25F * wavelet::lane_sum(larger(x * n.x() + y * n.y() + z * n.z(), Float4{}));
}

} // namespace

RegionPart HorizonRegion::classify(const Square& square) const {
  const RegionPart part = m_flat.classify(square);
  return part == RegionPart::Inside && (m_cosine || m_own) ? RegionPart::Partial : part;
}

float HorizonRegion::coverage(const Square& square) const {
  const float shown = m_cosine ? average_cosine(square, 0) : m_flat.coverage(square);
  return m_own && shown > 0 ? shown * unshadowed_share(square) : shown;
}

float HorizonRegion::average_cosine(const Square& square, int refinements) const {
  const RegionPart part = m_flat.classify(square);
  if (part == RegionPart::Outside)
    return 0;
  const bool crossed = part == RegionPart::Partial && refinements < horizon_refinements;
  if (square.level >= smooth_level && !crossed)
    return gauss_cosine(m_horizon.axis, square);
  const int done = square.level >= smooth_level ? refinements + 1 : 0;
  float sum = 0;
  for (unsigned q = 0; q < 4; ++q)
    sum += average_cosine(square.quadrant(q), done);
  return 0.25F * sum;
}

/// Of what lies above the horizon: more rays where the first few disagree.
float HorizonRegion::unshadowed_share(const Square& square) const {
  constexpr std::size_t few = 4;
  float all = 0;
  float missed = 0;
  for (std::size_t i = 0; i < net_size; ++i) {
    if (i == few && all > 0 && (missed == 0 || missed == all))
      break;
    const Vec3 w = wavelet::square_to_sphere(net_point(square, i));
    const float cosine = m_horizon.axis.dot(w);
    if (!(cosine > 0))
      continue;
    const float weight = m_cosine ? cosine : 1;
    all += weight;
    missed += m_own->meet(w) ? 0 : weight;
  }
  return all > 0 ? missed / all : 1;
}

} // namespace haarlight::renderer::detail
