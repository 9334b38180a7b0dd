// The part of adaptive products that knows what is in the light's way.

#include <wavelet/adaptive_product.h>
#include <wavelet/sphere_map.h>

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

/// The direction of a point of a leaf's square. @param s,t in [0, 1]
Vec3 direction_in(const ProductLeaf& leaf, float s, float t) {
  const float side = power_of_two(-leaf.level);
  return square_to_sphere(
      Vec2((static_cast<float>(leaf.x) + s) * side, (static_cast<float>(leaf.y) + t) * side));
}

void add_quadrants(const ProductLeaf& leaf, std::vector<Vec3>& directions) {
  for (const float t : {0.25F, 0.75F})
    for (const float s : {0.25F, 0.75F})
      directions.push_back(direction_in(leaf, s, t));
}

} // namespace

void AdaptiveProduct::mask(const AdaptiveOptions& options, const Occlusion& occlusion) {
  // A point in deep shadow has little light left to be right about: no more than as much again.
  m_limit = std::min(m_limit, 2 * m_product.m_leaf_count);
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
    add_quadrants(m_product.m_leaves[m_candidates[i]], m_directions);
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
  for (std::size_t i = 0; i < m_shares.size(); ++i) {
    const ProductLeaf& leaf = m_product.m_leaves[i];
    if (m_shares[i].tested || !(m_shares[i].density * power_of_two(-2 * leaf.level) > least))
      continue;
    m_candidates.push_back(static_cast<std::uint32_t>(i));
    m_directions.push_back(direction_in(leaf, 0.5F, 0.5F));
  }
}

/// Leaves a leaf that had all of its density a share of it.
void AdaptiveProduct::keep(std::uint32_t leaf, float share) {
  m_shares[leaf].kept = share;
  const ProductLeaf& square = m_product.m_leaves[leaf];
  const auto lost = static_cast<double>(1 - share);
  m_weight -= lost * static_cast<double>(m_product.weight(square));
  m_error -= lost * static_cast<double>(m_errors[leaf]);
  m_errors[leaf] *= share;
  m_product.weight_at(square.slot) = share * m_shares[leaf].density;
}

/// Gives every leaf its density back.
void AdaptiveProduct::unmask() {
  m_weight = 0;
  m_error = 0;
  for (std::size_t i = 0; i < m_shares.size(); ++i) {
    detail::LeafShare& share = m_shares[i];
    const ProductLeaf& leaf = m_product.m_leaves[i];
    m_errors[i] /= share.kept;
    share = {share.density};
    m_product.weight_at(leaf.slot) = share.density;
    m_weight += static_cast<double>(share.density * power_of_two(-2 * leaf.level));
    m_error += static_cast<double>(m_errors[i]);
  }
  m_masked = false;
}

} // namespace haarlight::wavelet
