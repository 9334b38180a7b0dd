// The part of adaptive products that knows what is in the light's way.

#include <wavelet/adaptive_product.h>

#include <algorithm>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Leaves below this share of the total are not worth a test.
constexpr double least_share = 0.001;

/// What is kept of a leaf of which nothing is seen.
constexpr float least_kept = 0.01F;

/// Hiding moves the weight to other squares, and shows which lie across an edge; those are then
/// refined and tested in turn.
constexpr int rounds = 4;

/// What refinement may multiply leaves by.
constexpr std::size_t most_growth = 2;

} // namespace

void AdaptiveProduct::mask(const AdaptiveOptions& options, Occlusion& occlusion) {
  // A point in deep shadow has little light left to be right about.
  m_limit = std::min(m_limit, most_growth * m_open_leaves);
  for (int round = 0; round < rounds && hide(occlusion); ++round)
    refine(options);
  m_limit = static_cast<std::size_t>(options.max_leaves);
}

/// Whether what was refined for points before leaves no room for this one.
bool AdaptiveProduct::is_overgrown() const {
  return 2 * m_product.leaf_count() > (most_growth + 1) * m_open_leaves;
}

/// Tests the leaves of weight that were not tested yet. @return whether any is hidden
bool AdaptiveProduct::hide(Occlusion& occlusion) {
  find_candidates();
  m_seen.resize(m_places.size());
  occlusion.find(m_places, m_seen);
  bool hidden = false;
  for (std::size_t i = 0; i < m_candidates.size(); ++i) {
    m_shares[m_candidates[i]].tested = true;
    m_shares[m_candidates[i]].error = m_errors[m_candidates[i]];
    if (m_seen[i] == 1)
      continue;
    keep(m_candidates[i], m_seen[i]);
    hidden = true;
  }
  m_masked = m_masked || hidden;
  return hidden;
}

void AdaptiveProduct::find_candidates() {
  m_candidates.clear();
  m_places.clear();
  const auto least = static_cast<float>(least_share * m_weight);
  for (std::uint32_t slot = 0; slot < slot_count(); ++slot) {
    if (m_shares[slot].tested || !(m_shares[slot].density * area(slot) > least))
      continue;
    m_candidates.push_back(slot);
    m_places.push_back(square(slot));
  }
}

/// Leaves a leaf that had all of its density what it is worth. With the share c of leaf i seen, its
/// weight w_i counts as w_i √c in the second moment: variance is least if its density is in
/// proportion to that, and Σ w_i (√c − c) of the mean is then what splitting could get rid of.
void AdaptiveProduct::keep(std::uint32_t slot, float seen) {
  detail::LeafShare& leaf = m_shares[slot];
  const float weight = leaf.density * area(slot);
  leaf.kept = std::max(least_kept, std::sqrt(seen));
  const float across = seen > 0 ? 2 * (leaf.kept - seen) * weight : 0;
  m_errors[slot] = leaf.kept * leaf.error + across;
  m_weight -= static_cast<double>((1 - leaf.kept) * weight);
  m_error += static_cast<double>(m_errors[slot] - leaf.error);
  m_product.weight_at(static_cast<std::int32_t>(slot)) = leaf.kept * leaf.density;
}

/// Gives every leaf its density back.
void AdaptiveProduct::unmask() {
  m_weight = 0;
  m_error = 0;
  for (std::uint32_t slot = 0; slot < slot_count(); ++slot) {
    if (!is_leaf(slot))
      continue;
    detail::LeafShare& share = m_shares[slot];
    if (share.tested)
      m_errors[slot] = share.error;
    share = {share.density};
    m_product.weight_at(static_cast<std::int32_t>(slot)) = share.density;
    m_weight += static_cast<double>(share.density * area(slot));
    m_error += static_cast<double>(m_errors[slot]);
  }
  m_masked = false;
}

} // namespace haarlight::wavelet
