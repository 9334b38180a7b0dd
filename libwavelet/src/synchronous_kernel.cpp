#include "synchronous_kernel.h"

#include <wavelet/cpu_clones.h>

#include <algorithm>

namespace haarlight::wavelet::detail {
namespace {

/// For every set of quadrants, as bits.
struct QuadrantSets {
  Int4 rank[16];   ///< of each quadrant, how many before it are in the set
  Int4 absent[16]; ///< −1 where a quadrant is not in the set
  Int4 members[16]; ///< those in the set, one after the other
};

constexpr QuadrantSets quadrant_sets() {
  QuadrantSets sets = {};
  for (unsigned set = 0; set < 16; ++set) {
    std::int32_t rank[4] = {};
    std::int32_t absent[4] = {};
    std::int32_t members[4] = {};
    std::int32_t count = 0;
    for (unsigned q = 0; q < 4; ++q) {
      const bool present = (set >> q & 1U) != 0;
      rank[q] = count;
      absent[q] = present ? 0 : -1;
      if (present)
        members[count++] = static_cast<std::int32_t>(q);
    }
    sets.rank[set] = Int4{rank[0], rank[1], rank[2], rank[3]};
    sets.absent[set] = Int4{absent[0], absent[1], absent[2], absent[3]};
    sets.members[set] = Int4{members[0], members[1], members[2], members[3]};
  }
  return sets;
}

constexpr QuadrantSets sets = quadrant_sets();

template <class V, class T>
V load(const T* from) {
  V result;
  std::memcpy(&result, from, sizeof result);
  return result;
}

template <class V, class T>
void store(T* to, const V& value) {
  std::memcpy(to, &value, sizeof value);
}

/// Bit q: lane q is negative.
unsigned signs(Int4 v) {
#ifdef __SSE2__
  return static_cast<unsigned>(__builtin_ia32_movmskps(std::bit_cast<Float4>(v)));
#else
  const Int4 bits = (v < 0) & Int4{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
#endif
}

/// Differences of a node as they are seen.
Details turned(const Details& d, const TreeTurn& turn) {
  const Details swapped = turn.swaps ? Details{d.d2, d.d1, d.d3} : d;
  return {swapped.d1 * turn.sign_x, swapped.d2 * turn.sign_y, d.d3 * (turn.sign_x * turn.sign_y)};
}

Int4 vanishing(const Float4* means) {
  Float4 r = means[0];
  Float4 g = means[1];
  Float4 b = means[2];
  Float4 rest = means[3];
  transpose(r, g, b, rest);
  return (r == 0) & (g == 0) & (b == 0);
}

/// @tparam count of factors, or 0: any
template <std::size_t count>
void look(ProductRun& run) {
  const std::size_t factors = count > 0 ? count : run.factors.size();
  const Int4 may_split = Int4{} - static_cast<std::int32_t>(run.splits);
  for (std::size_t i = 0; i < run.squares; ++i) {
    Int4 detailed = {};
    Int4 rest = {};
    Int4 node = Int4{} - 1;
    Int4 is_tree = {};
    for (std::size_t f = 0; f < factors; ++f) {
      const ProductFactor& factor = run.factors[f];
      const auto detail = load<Int4>(factor.details + 4 * i);
      const Int4 constant = detail == -1;
      detailed += constant + 1;
      rest = constant ? rest : Int4{} + static_cast<std::int32_t>(f);
      node = constant ? node : detail;
      is_tree = constant ? is_tree : Int4{} + factor.is_tree;
    }
    const Int4 ends = (detailed == 0) | ((detailed == 1) & is_tree);
    Int4 splits = ~ends & may_split;
    const Int4 doubtful = splits & (detailed < static_cast<std::int32_t>(factors));
    if (signs(doubtful) != 0)
      for (std::size_t f = 0; f < factors; ++f)
        splits &= ~(vanishing(run.factors[f].means + 4 * i) &
                    (load<Int4>(run.factors[f].details + 4 * i) == -1));
    const unsigned set = signs(splits);
    const auto split_count = static_cast<std::int32_t>(run.split_count);
    const auto leaf_count = static_cast<std::int32_t>(run.leaf_count);
    const Int4 child = splits ? sets.rank[set] + (run.next_node + split_count)
                              : ~(sets.rank[15 ^ set] + (run.next_leaf + leaf_count));
    const auto first = static_cast<std::int32_t>(4 * i);
    store(run.nodes[i].child, child);
    store(run.split_quadrants.data() + split_count, sets.members[set] + first);
    store(run.leaf_quadrants.data() + leaf_count, sets.members[15 ^ set] + first);
    store(run.rest.data() + 4 * i, rest);
    store(run.rest_node.data() + 4 * i, ends ? node : Int4{} - 1);
    run.split_count += bits_of_nibble(set);
    run.leaf_count += 4 - bits_of_nibble(set);
  }
}

template <std::size_t count>
void make_leaves(ProductRun& run) {
  const std::size_t factors = count > 0 ? count : run.factors.size();
  Float4 sum = run.leaf_sum;
  for (std::size_t i = 0; i < run.leaf_count; ++i) {
    const auto quadrant = static_cast<std::size_t>(run.leaf_quadrants[i]);
    const auto rest = static_cast<std::size_t>(run.rest[quadrant]);
    const ProductFactor& left = run.factors[rest];
    Float4 others = {1, 1, 1, 0};
    if constexpr (count == 2)
      others = run.factors[1 - rest].means[quadrant];
    else
      for (std::size_t f = 0; f < factors; ++f)
        if (f != rest)
          others *= run.factors[f].means[quadrant];
    const Float4 light = left.means[quadrant];
    ProductLeaf& leaf = run.leaves[i];
    leaf.light = light;
    leaf.reflectance = others;
    leaf.node = run.rest_node[quadrant];
    leaf.slot = 4 * run.first_node + static_cast<std::int32_t>(quadrant);
    leaf.level = static_cast<std::uint8_t>(run.level);
    leaf.rest = static_cast<std::uint8_t>(rest);
    sum += light * others;
    const float weight = lane_sum(light * larger(others, left.floor) * luminance_lanes);
    run.nodes[quadrant / 4].weights[quadrant % 4] = std::max(weight, 0.0F);
  }
  run.leaf_sum = sum;
}

} // namespace

HAARLIGHT_CPU_CLONES void split_tree(const TreeView& view, const TreeTurn& turn,
                                     const FactorSquares& squares, const FactorQuadrants& out) {
  const TreeView tree = view;
  const TreeTurn t = turn;
  const FactorSquares in = squares;
  Float4* means = out.mean;
  std::uint32_t* details = out.detail;
  for (std::size_t i = 0; i < in.count; ++i, means += 4, details += 4) {
    const std::uint32_t node = in.detail[i];
    if (node == no_node) {
      std::fill_n(means, 4, in.mean[i]);
      std::fill_n(details, 4, no_node);
      continue;
    }
    store(means, turned(tree.details(node), t).children(in.mean[i]));
    const std::uint32_t link = tree.links[node];
    const std::uint32_t set = link & 15U;
    const Int4 nodes =
        (sets.rank[set] + static_cast<std::int32_t>(link >> 4U)) | sets.absent[set];
    store(details, __builtin_shuffle(nodes, t.stored));
  }
}

HAARLIGHT_CPU_CLONES void finish_run(ProductRun& run) {
  run.split_count = 0;
  run.leaf_count = 0;
  run.leaf_sum = Float4{};
  if (run.factors.size() == 2) {
    look<2>(run);
    make_leaves<2>(run);
  } else {
    look<0>(run);
    make_leaves<0>(run);
  }
}

} // namespace haarlight::wavelet::detail
