// The part of adaptive products that weighs squares by what is seen of them.

#include <wavelet/product/adaptive_product.h>

#include "product/product_kernel.h"

#include <algorithm>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// What is kept of a square of which nothing is seen: rays round otherwise than squares do.
constexpr float least_visible = 1e-5F;

} // namespace

/// Weighs the quadrants of nodes from `first` on by what is seen of them.
void AdaptiveProduct::look(std::size_t first, std::span<detail::Quadrants> quadrants) {
  find_lookouts(first, quadrants);
  m_visibility->look(m_places, m_views);
  for (std::size_t i = 0; i < m_candidates.size(); ++i) {
    const std::uint32_t slot = m_candidates[i];
    m_occluders[slot] = m_views[i].occluders;
    keep(slot, m_views[i].seen, quadrants[slot / 4 - first]);
  }
}

/// The quadrants that are worth a look and may have something in their way.
void AdaptiveProduct::find_lookouts(std::size_t first,
                                    std::span<const detail::Quadrants> quadrants) {
  m_candidates.clear();
  m_places.clear();
  m_views.clear();
  m_occluders.resize(m_errors.size(), SquareView{}.occluders);
  for (std::size_t i = 0; i < quadrants.size(); ++i) {
    const std::uint64_t occluders =
        m_occluders[static_cast<std::size_t>(m_parent_slots[first + i])];
    for (unsigned q = 0; q < 4; ++q) {
      const auto slot = static_cast<std::uint32_t>(4 * (first + i) + q);
      m_occluders[slot] = occluders;
      if (occluders == 0 || !(quadrants[i].density[q] > 0))
        continue;
      m_candidates.push_back(slot);
      m_places.push_back(square(slot));
      m_views.push_back({1, occluders});
    }
  }
}

/// Leaves a quadrant what it is worth. With the share c of a square seen, its weight w counts as
/// w √c in the second moment: variance is least if its density is in proportion to that, and
/// w (√c − c) is then what splitting could get rid of, twice over as variances go.
void AdaptiveProduct::keep(std::uint32_t slot, float seen, detail::Quadrants& quadrants) const {
  const unsigned q = slot & 3U;
  const float weight = quadrants.density[q] * area(slot);
  const float kept = std::max(least_visible, std::sqrt(seen));
  quadrants.density[q] *= kept;
  quadrants.error[q] *= kept;
  if (seen > 0 && square(slot).level < m_reflectance.pyramid->levels())
    quadrants.error[q] += 2 * (kept - seen) * weight;
}

} // namespace haarlight::wavelet
