#include "product/synchronous_kernel.h"

#include <wavelet/base/cpu_clones.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace haarlight::wavelet::detail {
namespace {

/// For every set of quadrants, as bits.
struct QuadrantSets {
  Int4 rank[16];    ///< of each quadrant, how many before it are in the set
  Int4 absent[16];  ///< −1 where a quadrant is not in the set
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

/// Differences of a tree's nodes as they are seen.
struct TurnedDetails {
  TreeView tree;
  TreeTurn turn;

  Details operator()(std::uint32_t node) const {
    const Details d = tree.details(node);
    return {(turn.swaps ? d.d2 : d.d1) * turn.sign_x, (turn.swaps ? d.d1 : d.d2) * turn.sign_y,
            d.d3 * (turn.sign_x * turn.sign_y)};
  }
};

/// The same of RGB halves, the common case.
class TurnedHalves {
public:
  /// Whether the unit of a tree's halves can be joined with its scale.
  static bool suits(const TreeView& tree) {
    return tree.channels == 3 && tree.type == CoefficientType::Half && tree.scale < 0x1p15F;
  }

  TurnedHalves(const TreeView& tree, const TreeTurn& turn)
      : m_x(tree.coefficients + (turn.swaps ? 6 : 0)),
        m_y(tree.coefficients + (turn.swaps ? 0 : 6)), m_xy(tree.coefficients + 12) {
    const Float4 unit = Float4{1, 1, 1, 0} * (tree.scale * half_unit);
    m_unit_x = unit * turn.sign_x;
    m_unit_y = unit * turn.sign_y;
    m_unit_xy = m_unit_x * turn.sign_y;
  }

  Details operator()(std::uint32_t node) const {
    const std::size_t offset = std::size_t{18} * node;
    return {small_floats(m_x + offset) * m_unit_x, small_floats(m_y + offset) * m_unit_y,
            small_floats(m_xy + offset) * m_unit_xy};
  }

private:
  const std::byte* m_x; ///< where the first node's differences lie
  const std::byte* m_y;
  const std::byte* m_xy;
  Float4 m_unit_x, m_unit_y, m_unit_xy;
};

template <class DetailsOf>
void split_tree(const DetailsOf& details_of, const std::uint32_t* links, const TreeTurn& turn,
                const FactorSquares& squares, const FactorQuadrants& out) {
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
    const auto children = details_of(node).children(in.mean[slot]);
    for (std::size_t q = 0; q < 4; ++q)
      means[q] = children[q];
    const std::uint32_t set = links[node] & 15U;
    const Int4 nodes =
        (sets.rank[set] + static_cast<std::int32_t>(links[node] >> 4U)) | sets.absent[set];
    if (turn.plain)
      store(details, nodes);
    else
      for (std::size_t q = 0; q < 4; ++q)
        details[q] = static_cast<std::uint32_t>(nodes[turn.stored[q]]);
  }
}

/// Four quadrants, channel by channel.
struct Colours {
  Float4 r, g, b;

  explicit Colours(const Float4* means) : r(means[0]), g(means[1]), b(means[2]) {
    Float4 rest = means[3];
    transpose(r, g, b, rest);
  }
};

/// Quadrants of a node over which some factor is 0 throughout.
Int4 vanishing(const SplitSquares& squares, std::size_t node) {
  Int4 result = {};
  for (const ProductFactor& factor : squares.factors) {
    const Colours mean(factor.means + 4 * node);
    const Int4 constant = load<Int4>(factor.details + 4 * node) == -1;
    result |= constant & (mean.r == 0) & (mean.g == 0) & (mean.b == 0);
  }
  return result;
}

/// Which of a node's quadrants want splitting. Handles on what is left of the others vanish unless
/// they belong to the one tree that has detail there.
struct SplitsOfAny {
  const SplitSquares& squares;

  Int4 operator()(std::size_t node) const {
    Int4 constant_factors = {};
    Int4 non_trees = {};
    for (const ProductFactor& factor : squares.factors) {
      const Int4 constant = load<Int4>(factor.details + 4 * node) == -1;
      constant_factors -= constant;
      non_trees |= ~(constant | factor.is_tree);
    }
    const auto all = static_cast<std::int32_t>(squares.factors.size());
    const Int4 ends =
        (constant_factors == all) | ((constant_factors == all - 1) & (non_trees == 0));
    const Int4 splits = squares.may_split ? ~(ends | vanishing(squares, node)) : Int4{};
    const Int4 cut = ~(ends | splits);
    if (signs(cut) != 0)
      for (const ProductFactor& factor : squares.factors)
        store(factor.details + 4 * node, load<Int4>(factor.details + 4 * node) | cut);
    return splits;
  }
};

/// The same of two trees.
struct SplitsOfTwoTrees {
  const std::uint32_t* first;
  const std::uint32_t* second;

  Int4 operator()(std::size_t node) const {
    return (load<Int4>(first + 4 * node) != -1) & (load<Int4>(second + 4 * node) != -1);
  }
};

template <class SplitsOf>
void name_children(SplitSquares& squares, const SplitsOf& splits_of) {
  std::size_t node_count = squares.node_count;
  ProductNode* const nodes = squares.nodes;
  std::int32_t* const parent_slots = squares.parent_slots;
  for (std::size_t node = squares.begin, end = squares.end; node < end; ++node) {
    const Int4 splits = splits_of(node);
    const unsigned set = signs(splits);
    const auto slot = static_cast<std::int32_t>(4 * node);
    const Int4 child = sets.rank[set] + static_cast<std::int32_t>(node_count);
    store(nodes[node].child, splits ? child : Int4{~0, ~1, ~2, ~3} - slot);
    store(parent_slots + node_count, sets.members[set] + slot);
    node_count += bits_of_nibble(set);
  }
  squares.node_count = node_count;
}

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
    const Float4 weights = floored_product(x.r, y.r, second_left, first.floor[0], second.floor[0]) *
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

/// The last factor that has detail.
std::size_t factor_left(const SplitSquares& squares, std::size_t slot) {
  std::size_t left = squares.factors.size() - 1;
  while (left > 0 && squares.factors[left].details[slot] == no_node)
    --left;
  return left;
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

HAARLIGHT_CPU_CLONES void split_tree(const TreeView& tree, const TreeTurn& turn,
                                     const FactorSquares& squares, const FactorQuadrants& out) {
  if (TurnedHalves::suits(tree))
    split_tree(TurnedHalves(tree, turn), tree.links, turn, squares, out);
  else
    split_tree(TurnedDetails{tree, turn}, tree.links, turn, squares, out);
}

HAARLIGHT_CPU_CLONES void finish(SplitSquares& squares) {
  const std::span<const ProductFactor> factors = squares.factors;
  if (factors.size() == 2 && factors[0].is_tree != 0 && factors[1].is_tree != 0 &&
      squares.may_split)
    name_children(squares, SplitsOfTwoTrees{factors[0].details, factors[1].details});
  else
    name_children(squares, SplitsOfAny{squares});
  if (factors.size() == 2)
    weigh_pairs(squares);
  else
    weigh_any(squares);
}

} // namespace haarlight::wavelet::detail
