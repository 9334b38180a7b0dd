#include "hidden_share.h"

#include <algorithm>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::SquarePlace;

namespace {

/// Bounds of squares are kept down to this level.
constexpr int kept_levels = 8;

SquarePlace quadrant(const SquarePlace& s, unsigned q) {
  return {s.level + 1, 2 * s.column + (q & 1U), 2 * s.row + (q >> 1U)};
}

} // namespace

HiddenShare::HiddenShare(int levels) {
  const int kept = std::min(levels, kept_levels);
  std::vector<SquarePlace> places = {SquarePlace{}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    m_bounds.push_back(wavelet::square_cap(places[i]));
    if (places[i].level < kept)
      for (unsigned q = 0; q < 4; ++q)
        places.push_back(quadrant(places[i], q));
  }
}

Rgb HiddenShare::within(const wavelet::TreeView& tree, const Cap& cap) const {
  return wavelet::to_rgb(
      within(tree, tree.root(), wavelet::to_lanes(tree.mean), {0, SquarePlace{}}, cap));
}

RegionPart HiddenShare::classify(const Square& square, const Cap& cap) const {
  return cap.classify(square.index < m_bounds.size() ? m_bounds[square.index]
                                                     : wavelet::square_cap(square.place));
}

Float4 HiddenShare::within(const wavelet::TreeView& tree, std::uint32_t node, Float4 mean,
                           const Square& square, const Cap& cap) const {
  const RegionPart part = classify(square, cap);
  if (part == RegionPart::Outside || wavelet::lane_sum(mean * wavelet::luminance_lanes) == 0)
    return Float4{};
  if (part == RegionPart::Inside)
    return mean;
  if (node == wavelet::no_node)
    return mean * CapRegion(cap, false).coverage(square.place);
  const auto means = tree.details(node).children(mean);
  const auto children = tree.children(node);
  Float4 sum = {};
  for (unsigned q = 0; q < 4; ++q)
    sum += within(tree, children[q], means[q],
                  {4 * square.index + 1 + q, quadrant(square.place, q)}, cap);
  return 0.25F * sum;
}

} // namespace haarlight::renderer::detail
