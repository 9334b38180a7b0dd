// The part of adaptive products that knows what is in the light's way.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::wavelet {
namespace {

/// Leaves below this share of the total are not worth a test.
constexpr double least_share = 0.003;

/// What is kept of a leaf whose centre is hidden: as much of it as its quadrants' centres see, but
/// never less than this.
constexpr float least_kept = 0.04F;

/// Hiding moves the weight to other squares, which are then refined and tested in turn.
constexpr int rounds = 3;

Vec3 center_of(const SquarePlace& square) {
  const float side = power_of_two(-square.level);
  return square_to_sphere(Vec2((static_cast<float>(square.column) + 0.5F) * side,
                               (static_cast<float>(square.row) + 0.5F) * side));
}

} // namespace

void AdaptiveProduct::mask(const AdaptiveOptions& options, const Occlusion& occlusion) {
  // A point in deep shadow has little light left to be right about: no more than as much again.
  m_limit = std::min(m_limit, 2 * m_product.leaf_count());
  for (int round = 0; round < rounds && hide(occlusion); ++round)
    refine(options);
  m_limit = static_cast<std::size_t>(options.max_leaves);
}

/// Tests the leaves of weight that were not tested yet. @return whether any is hidden
bool AdaptiveProduct::hide(const Occlusion& occlusion) {
  find_candidates();
  m_hidden.resize(m_candidates.size());
  occlusion.find(m_directions, m_hidden);
  m_directions.clear();
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < m_candidates.size(); ++i) {
    m_shares[m_candidates[i]].tested = true;
    if (m_hidden[i] == 0)
      continue;
    for (unsigned q = 0; q < 4; ++q)
      m_directions.push_back(center_of(square(m_candidates[i]).quadrant(q)));
    m_candidates[hidden++] = m_candidates[i];
  }
  m_hidden.resize(4 * hidden);
  occlusion.find(m_directions, m_hidden);
  for (std::size_t i = 0; i < hidden; ++i) {
    const int covered =
        m_hidden[4 * i] + m_hidden[4 * i + 1] + m_hidden[4 * i + 2] + m_hidden[4 * i + 3];
    keep(m_candidates[i], std::max(least_kept, 1 - 0.25F * static_cast<float>(covered)));
  }
  m_masked = m_masked || hidden > 0;
  return hidden > 0;
}

void AdaptiveProduct::find_candidates() {
  m_candidates.clear();
  m_directions.clear();
  const auto least = static_cast<float>(least_share * m_weight);
  for (std::uint32_t slot = 0; slot < slot_count(); ++slot) {
    if (m_shares[slot].tested || !(m_shares[slot].density * area(slot) > least))
      continue;
    m_candidates.push_back(slot);
    m_directions.push_back(center_of(square(slot)));
  }
}

/// Leaves a leaf that had all of its density a share of it.
void AdaptiveProduct::keep(std::uint32_t slot, float share) {
  detail::LeafShare& leaf = m_shares[slot];
  const auto lost = static_cast<double>(1 - share);
  leaf.kept = share;
  m_weight -= lost * static_cast<double>(leaf.density * area(slot));
  m_error -= lost * static_cast<double>(m_errors[slot]);
  m_errors[slot] *= share;
  m_product.weight_at(static_cast<std::int32_t>(slot)) = share * leaf.density;
}

/// Gives every leaf its density back.
void AdaptiveProduct::unmask() {
  m_weight = 0;
  m_error = 0;
  for (std::uint32_t slot = 0; slot < slot_count(); ++slot) {
    if (!is_leaf(slot))
      continue;
    detail::LeafShare& share = m_shares[slot];
    m_errors[slot] /= share.kept;
    share = {share.density};
    m_product.weight_at(static_cast<std::int32_t>(slot)) = share.density;
    m_weight += static_cast<double>(share.density * area(slot));
    m_error += static_cast<double>(m_errors[slot]);
  }
  m_masked = false;
}

} // namespace haarlight::wavelet
