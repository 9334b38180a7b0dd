#include "transfer/hidden_share.h"

#include <algorithm>
#include <cmath>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::Square;

namespace {

/// Bounds of squares are kept down to this level.
constexpr int kept_levels = 8;

/// A cap's edge counts as straight within squares no coarser than this level, no wider than this
/// share of the cap, …
constexpr int straight_level = 5;
constexpr float straight_share = 0.25F;

/// … of any size from this level on, …
constexpr int finest_level = kept_levels;

/// … and where a square holds less than this share of the whole.
constexpr float negligible_share = 1e-3F;

/// Half a square's mean width, of the radius of the circle around it.
constexpr float half_width = 0.8F;

bool edge_is_straight(const wavelet::SquareCap& bounds, int level, const Cap& cap) {
  return level >= straight_level && bounds.sine <= straight_share * cap.sine;
}

/// The share of a square on the cap's side of its edge, by the distance of its centre from it.
float share_inside(const wavelet::SquareCap& bounds, const Cap& cap) {
  const float along = cap.axis.dot(bounds.centre);
  const float across = std::sqrt(std::max(1 - along * along, 0.0F));
  const float inside = cap.sine * along - cap.cosine * across;
  return std::clamp(0.5F + 0.5F * inside / (half_width * bounds.sine), 0.0F, 1.0F);
}

} // namespace

HiddenShare::HiddenShare() {
  std::vector<Square> places = {Square{}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    m_bounds.push_back(wavelet::square_cap(places[i]));
    if (places[i].level < kept_levels)
      for (unsigned q = 0; q < 4; ++q)
        places.push_back(places[i].quadrant(q));
  }
}

Rgb HiddenShare::within(const wavelet::TreeView& tree, const Cap& cap) const {
  const Walk walk = {tree, cap, negligible_share * luminance(tree.mean)};
  return wavelet::to_rgb(within(walk, tree.root(), wavelet::to_lanes(tree.mean), {0, 0}));
}

Float4 HiddenShare::within(const Walk& walk, std::uint32_t node, Float4 mean,
                           const Place& square) const {
  const wavelet::SquareCap& bounds = m_bounds[square.index];
  const float weight = wavelet::lane_sum(mean * wavelet::luminance_lanes);
  const RegionPart part = walk.cap.classify(bounds);
  if (part == RegionPart::Outside || !(weight > 0))
    return Float4{};
  if (part == RegionPart::Inside)
    return mean;
  const bool constant = node == wavelet::no_node;
  if (square.level == finest_level || weight * power_of_two(-2 * square.level) <= walk.negligible ||
      (constant && edge_is_straight(bounds, square.level, walk.cap)))
    return mean * share_inside(bounds, walk.cap);
  const wavelet::TreeQuadrants quadrants = walk.tree.split(node, mean);
  Float4 sum = {};
  for (unsigned q = 0; q < 4; ++q)
    sum += within(walk, quadrants.nodes[q], quadrants.means[q],
                  {4 * square.index + 1 + q, square.level + 1});
  return 0.25F * sum;
}

} // namespace haarlight::renderer::detail
