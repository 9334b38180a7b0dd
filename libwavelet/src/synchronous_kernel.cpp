#include "synchronous_kernel.h"

#include <wavelet/cpu_clones.h>

#include <algorithm>
#include <limits>

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

/// Quadrants of a node over which some factor is 0 throughout.
Int4 vanishing(const SplitSquares& squares, std::size_t node) {
  Int4 result = {};
  for (const ProductFactor& factor : squares.factors)
    for (int q = 0; q < 4; ++q) {
      const std::size_t slot = 4 * node + static_cast<std::size_t>(q);
      const Float4 mean = factor.means[slot];
      if (factor.details[slot] == no_node && mean[0] == 0 && mean[1] == 0 && mean[2] == 0)
        result[q] = -1;
    }
  return result;
}

/// The last factor that has detail.
std::size_t factor_left(const SplitSquares& squares, std::size_t slot) {
  std::size_t left = squares.factors.size() - 1;
  while (left > 0 && squares.factors[left].details[slot] == no_node)
    --left;
  return left;
}

/// Which of a node's quadrants want splitting. Handles on what is left of the others vanish unless
/// they belong to the one tree that has detail there.
/// @tparam count of factors, or 0: any
template <std::size_t count>
Int4 find_splits(const SplitSquares& squares, std::size_t node) {
  const std::size_t factors = count > 0 ? count : squares.factors.size();
  Int4 constant_factors = {};
  Int4 non_trees = {};
  for (std::size_t f = 0; f < factors; ++f) {
    const Int4 constant = load<Int4>(squares.factors[f].details + 4 * node) == -1;
    constant_factors -= constant;
    non_trees |= ~(constant | squares.factors[f].is_tree);
  }
  const auto all = static_cast<std::int32_t>(factors);
  const Int4 ends =
      (constant_factors == all) | ((constant_factors == all - 1) & (non_trees == 0));
  Int4 splits = squares.may_split ? ~ends : Int4{};
  if (signs(splits & (constant_factors > 0)) != 0)
    splits &= ~vanishing(squares, node);
  const Int4 cut = ~(ends | splits);
  if (signs(cut) != 0)
    for (const ProductFactor& factor : squares.factors)
      store(factor.details + 4 * node, load<Int4>(factor.details + 4 * node) | cut);
  return splits;
}

template <std::size_t count>
void name_children(SplitSquares& squares) {
  std::size_t node_count = squares.node_count;
  for (std::size_t node = squares.begin; node < squares.end; ++node) {
    const Int4 splits = find_splits<count>(squares, node);
    const unsigned set = signs(splits);
    const Int4 slots = Int4{0, 1, 2, 3} + static_cast<std::int32_t>(4 * node);
    const Int4 nodes = sets.rank[set] + static_cast<std::int32_t>(node_count);
    store(squares.nodes[node].child, splits ? nodes : ~slots);
    store(squares.parent_slots + node_count,
          sets.members[set] + static_cast<std::int32_t>(4 * node));
    node_count += bits_of_nibble(set);
  }
  squares.node_count = node_count;
}

/// Four quadrants, channel by channel.
struct Colours {
  Float4 r, g, b;

  explicit Colours(const Float4* means) : r(means[0]), g(means[1]), b(means[2]) {
    Float4 rest = means[3];
    transpose(r, g, b, rest);
  }
};

/// One channel's share in the density: the factor that is left times the other or its floor.
Float4 floored_product(Float4 first, Float4 second, Int4 second_left, float first_floor,
                       float second_floor) {
  const Float4 lowest = Float4{} + std::numeric_limits<float>::lowest();
  return larger(first, select(second_left, Float4{} + second_floor, lowest)) *
         larger(second, select(second_left, lowest, Float4{} + first_floor));
}

void weigh_pairs(SplitSquares& squares) {
  const ProductFactor first = squares.factors[0];
  const ProductFactor second = squares.factors[1];
  Float4 r = {};
  Float4 g = {};
  Float4 b = {};
  for (std::size_t node = squares.begin; node < squares.end; ++node) {
    const Colours x(first.means + 4 * node);
    const Colours y(second.means + 4 * node);
    const Int4 second_left = load<Int4>(second.details + 4 * node) != -1;
    const Float4 weights =
        floored_product(x.r, y.r, second_left, first.floor[0], second.floor[0]) *
            luminance_lanes[0] +
        floored_product(x.g, y.g, second_left, first.floor[1], second.floor[1]) *
            luminance_lanes[1] +
        floored_product(x.b, y.b, second_left, first.floor[2], second.floor[2]) *
            luminance_lanes[2];
    squares.nodes[node].weights = larger(weights, Float4{});
    const Int4 leaf = load<Int4>(squares.nodes[node].child) < 0;
    r += select(leaf, x.r * y.r, Float4{});
    g += select(leaf, x.g * y.g, Float4{});
    b += select(leaf, x.b * y.b, Float4{});
  }
  squares.leaf_sum += Float4{lane_sum(r), lane_sum(g), lane_sum(b), 0};
}

void weigh_any(SplitSquares& squares) {
  for (std::size_t slot = 4 * squares.begin; slot < 4 * squares.end; ++slot) {
    ProductNode& node = squares.nodes[slot / 4];
    if (node.child[slot % 4] >= 0)
      continue;
    const std::size_t left = factor_left(squares, slot);
    Float4 others = {1, 1, 1, 0};
    for (std::size_t f = 0; f < squares.factors.size(); ++f)
      if (f != left)
        others *= squares.factors[f].means[slot];
    const Float4 light = squares.factors[left].means[slot];
    squares.leaf_sum += light * others;
    others = larger(others, squares.factors[left].floor);
    node.weights[slot % 4] = std::max(lane_sum(light * others * luminance_lanes), 0.0F);
  }
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
    const auto slot = static_cast<std::size_t>(in.slot[i]);
    const std::uint32_t node = in.detail[slot];
    if (node == no_node) {
      std::fill_n(means, 4, in.mean[slot]);
      std::fill_n(details, 4, no_node);
      continue;
    }
    const auto children = turned(tree.details(node), t).children(in.mean[slot]);
    for (std::size_t q = 0; q < 4; ++q)
      means[q] = children[q];
    const std::uint32_t link = tree.links[node];
    const std::uint32_t set = link & 15U;
    const Int4 nodes =
        (sets.rank[set] + static_cast<std::int32_t>(link >> 4U)) | sets.absent[set];
    store(details, __builtin_shuffle(nodes, t.stored));
  }
}

HAARLIGHT_CPU_CLONES void finish(SplitSquares& squares) {
  if (squares.factors.size() == 2) {
    name_children<2>(squares);
    weigh_pairs(squares);
  } else {
    name_children<0>(squares);
    weigh_any(squares);
  }
}

} // namespace haarlight::wavelet::detail
