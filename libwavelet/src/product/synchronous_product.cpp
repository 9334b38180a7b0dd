#include <wavelet/product/synchronous_product.h>

#include <wavelet/base/cpu_clones.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

namespace haarlight::wavelet {
namespace {

using FactorSlots = SynchronousProduct::FactorSlots;

/// In the density, the product of all factors but one counts as at least this share of its mean:
/// thresholding may have lost what a square once held.
constexpr float product_floor = 0.005F;

template <class T>
void grow(std::vector<T>& array, std::size_t size) {
  if (array.size() < size)
    array.resize(size);
}

/// By set of quadrants, as bits.
struct QuadrantSets {
  Int4 rank[16];    ///< of each quadrant: number of those before it in the set
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

/// Bit q: lane q is negative.
unsigned signs(Int4 v) {
#ifdef __SSE2__
  return static_cast<unsigned>(__builtin_ia32_movmskps(std::bit_cast<Float4>(v)));
#else
  const Int4 bits = (v < 0) & Int4{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
#endif
}

/// Differences of a tree's nodes, seen through a symmetry.
struct TurnedDetails {
  TreeView tree;
  TreeFactor::Turn turn;

  Details operator()(std::uint32_t node) const {
    const Details d = tree.details(node);
    return {(turn.swaps ? d.d2 : d.d1) * turn.sign_x, (turn.swaps ? d.d1 : d.d2) * turn.sign_y,
            d.d3 * (turn.sign_x * turn.sign_y)};
  }
};

/// The same for RGB halves, the common case.
class TurnedHalves {
public:
  /// Whether the unit of a tree's halves can be joined with its scale.
  static bool suits(const TreeView& tree) {
    return tree.channels == 3 && tree.type == CoefficientType::Half && tree.scale < 0x1p15F;
  }

  TurnedHalves(const TreeView& tree, const TreeFactor::Turn& turn)
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
void split_tree(const DetailsOf& details_of, const std::uint32_t* links,
                const TreeFactor::Turn& turn, const FactorSquares& squares,
                const FactorQuadrants& out) {
  const FactorSquares in = squares;
  Float4* means = out.mean;
  std::uint32_t* children = out.node;
  for (std::size_t i = 0; i < in.count; ++i, means += 4, children += 4) {
    const auto slot = static_cast<std::size_t>(in.slot[i]);
    const std::uint32_t node = in.node[slot];
    if (node == no_node) {
      std::fill_n(means, 4, in.mean[slot]);
      std::fill_n(children, 4, no_node);
      continue;
    }
    const auto quadrants = details_of(node).children(in.mean[slot]);
    for (std::size_t q = 0; q < 4; ++q)
      means[q] = quadrants[q];
    const std::uint32_t set = links[node] & 15U;
    const Int4 nodes =
        (sets.rank[set] + static_cast<std::int32_t>(links[node] >> 4U)) | sets.absent[set];
    if (turn.identity)
      store_lanes(children, nodes);
    else
      for (std::size_t q = 0; q < 4; ++q)
        children[q] = static_cast<std::uint32_t>(nodes[turn.stored[q]]);
  }
}

/// Squares whose quadrants are known for every factor, and their product. Arrays go by product
/// node.
struct SplitSquares {
  std::span<const FactorSlots> factors;
  std::size_t begin = 0; ///< the squares' product nodes
  std::size_t end = 0;
  bool may_split = true;      ///< quadrants may become nodes
  std::size_t node_count = 0; ///< grows by the quadrants that become nodes
  ProductNode* product_nodes = nullptr;
  std::int32_t* parent_slots = nullptr; ///< room for four more than all quadrants
  Float4 leaf_sum = {};                 ///< grows by the leaves' products
};

/// Four quadrants, one channel to a vector.
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
  for (const FactorSlots& factor : squares.factors) {
    const Colours mean(factor.means + 4 * node);
    const Int4 constant = load_lanes<Int4>(factor.nodes + 4 * node) == -1;
    result |= constant & (mean.r == 0) & (mean.g == 0) & (mean.b == 0);
  }
  return result;
}

/// Which of a node's quadrants are split. In the others, nodes are reset unless they belong to the
/// one tree that has detail there.
struct SplitsOfAny {
  const SplitSquares& squares;

  Int4 operator()(std::size_t node) const {
    Int4 constant_factors = {};
    Int4 not_remaining = {};
    for (const FactorSlots& factor : squares.factors) {
      const Int4 constant = load_lanes<Int4>(factor.nodes + 4 * node) == -1;
      constant_factors -= constant;
      not_remaining |= ~(constant | factor.can_remain);
    }
    const auto all = static_cast<std::int32_t>(squares.factors.size());
    const Int4 ends =
        (constant_factors == all) | ((constant_factors == all - 1) & (not_remaining == 0));
    const Int4 splits = squares.may_split ? ~(ends | vanishing(squares, node)) : Int4{};
    const Int4 cut = ~(ends | splits);
    if (signs(cut) != 0)
      for (const FactorSlots& factor : squares.factors)
        store_lanes(factor.nodes + 4 * node, load_lanes<Int4>(factor.nodes + 4 * node) | cut);
    return splits;
  }
};

/// The same for two trees.
struct SplitsOfTwoTrees {
  const std::uint32_t* first;
  const std::uint32_t* second;

  Int4 operator()(std::size_t node) const {
    return (load_lanes<Int4>(first + 4 * node) != -1) & (load_lanes<Int4>(second + 4 * node) != -1);
  }
};

template <class SplitsOf>
void add_children(SplitSquares& squares, const SplitsOf& splits_of) {
  std::size_t node_count = squares.node_count;
  ProductNode* const nodes = squares.product_nodes;
  std::int32_t* const parent_slots = squares.parent_slots;
  for (std::size_t node = squares.begin, end = squares.end; node < end; ++node) {
    const Int4 splits = splits_of(node);
    const unsigned set = signs(splits);
    const auto slot = static_cast<std::int32_t>(4 * node);
    const Int4 child = sets.rank[set] + static_cast<std::int32_t>(node_count);
    store_lanes(nodes[node].child, splits ? child : Int4{~0, ~1, ~2, ~3} - slot);
    store_lanes(parent_slots + node_count, sets.members[set] + slot);
    node_count += detail::bits_of_nibble(set);
  }
  squares.node_count = node_count;
}

/// One channel of the density: the remaining factor times the other or its floor.
Float4 floored_product(Float4 first, Float4 second, Int4 second_remains, float first_floor,
                       float second_floor) {
  const Float4 lowest = Float4{} + std::numeric_limits<float>::lowest();
  return larger(first, select(second_remains, Float4{} + second_floor, lowest)) *
         larger(second, select(second_remains, lowest, Float4{} + first_floor));
}

void weight_leaves_of_pair(SplitSquares& squares) {
  const FactorSlots first = squares.factors[0];
  const FactorSlots second = squares.factors[1];
  Float4 r = {};
  Float4 g = {};
  Float4 b = {};
  for (std::size_t node = squares.begin; node < squares.end; ++node) {
    const Colours x(first.means + 4 * node);
    const Colours y(second.means + 4 * node);
    const Int4 second_remains = load_lanes<Int4>(second.nodes + 4 * node) != -1;
    const Float4 weights =
        floored_product(x.r, y.r, second_remains, first.floor[0], second.floor[0]) *
            luminance_lanes[0] +
        floored_product(x.g, y.g, second_remains, first.floor[1], second.floor[1]) *
            luminance_lanes[1] +
        floored_product(x.b, y.b, second_remains, first.floor[2], second.floor[2]) *
            luminance_lanes[2];
    squares.product_nodes[node].weights = larger(weights, Float4{});
    const Int4 leaf = load_lanes<Int4>(squares.product_nodes[node].child) < 0;
    r += select(leaf, x.r * y.r, Float4{});
    g += select(leaf, x.g * y.g, Float4{});
    b += select(leaf, x.b * y.b, Float4{});
  }
  squares.leaf_sum += Float4{lane_sum(r), lane_sum(g), lane_sum(b), 0};
}

/// The remaining factor of a leaf: the last that has detail.
std::size_t remaining_factor(const SplitSquares& squares, std::size_t slot) {
  std::size_t remaining = squares.factors.size() - 1;
  while (remaining > 0 && squares.factors[remaining].nodes[slot] == no_node)
    --remaining;
  return remaining;
}

void weight_leaves(SplitSquares& squares) {
  for (std::size_t slot = 4 * squares.begin; slot < 4 * squares.end; ++slot) {
    ProductNode& node = squares.product_nodes[slot / 4];
    if (node.child[slot % 4] >= 0)
      continue;
    const std::size_t remaining = remaining_factor(squares, slot);
    Float4 others = {1, 1, 1, 0};
    for (std::size_t f = 0; f < squares.factors.size(); ++f)
      if (f != remaining)
        others *= squares.factors[f].means[slot];
    const Float4 light = squares.factors[remaining].means[slot];
    squares.leaf_sum += light * others;
    others = larger(others, squares.factors[remaining].floor);
    node.weights[slot % 4] = std::max(lane_sum(light * others * luminance_lanes), 0.0F);
  }
}

/// Makes every quadrant a node or a leaf, and sets the weights of leaves.
HAARLIGHT_CPU_CLONES void multiply_quadrants(SplitSquares& squares) {
  const std::span<const FactorSlots> factors = squares.factors;
  if (factors.size() == 2 && factors[0].can_remain != 0 && factors[1].can_remain != 0 &&
      squares.may_split)
    add_children(squares, SplitsOfTwoTrees{factors[0].nodes, factors[1].nodes});
  else
    add_children(squares, SplitsOfAny{squares});
  if (factors.size() == 2)
    weight_leaves_of_pair(squares);
  else
    weight_leaves(squares);
}

} // namespace

TreeFactor::Turn::Turn(const SquareSymmetry& symmetry)
    : stored{symmetry.to_stored(0U), symmetry.to_stored(1U), symmetry.to_stored(2U),
             symmetry.to_stored(3U)},
      identity(symmetry.turns == 0 && !symmetry.mirrored), swaps((stored[0] ^ stored[1]) == 2),
      sign_x((stored[0] & (swaps ? 2U : 1U)) == 0 ? 1.0F : -1.0F),
      sign_y((stored[0] & (swaps ? 1U : 2U)) == 0 ? 1.0F : -1.0F) {}

TreeFactor::TreeFactor(const TreeView& view, const SquareSymmetry& symmetry)
    : m_view(view), m_turn(symmetry) {}

HAARLIGHT_CPU_CLONES void TreeFactor::split(const FactorSquares& squares,
                                            const FactorQuadrants& out) const {
  if (TurnedHalves::suits(m_view))
    split_tree(TurnedHalves(m_view, m_turn), m_view.links, m_turn, squares, out);
  else
    split_tree(TurnedDetails{m_view, m_turn}, m_view.links, m_turn, squares, out);
}

const ProductTree& SynchronousProduct::build(std::span<const TreeFactor> factors,
                                             int finest_level) {
  assert(!factors.empty() && factors.size() < 256 && finest_level >= 1 && finest_level <= 30);
  m_factors = factors;
  m_finest_level = finest_level;
  m_integral = Float4{};
  prepare_factors();
  start();
  std::size_t begin = 1;
  for (std::int32_t level = 2; begin < m_node_count; ++level) {
    const std::size_t end = m_node_count;
    make_room(begin, end);
    for (; begin < end; begin = std::min(begin + run, end))
      split(begin, std::min(begin + run, end), level);
  }
  for (ProductTree::Slots& slots : m_product.m_slots) {
    slots.means.resize(4 * m_node_count);
    slots.nodes.resize(4 * m_node_count);
  }
  m_product.m_nodes.resize(m_node_count);
  m_product.m_integral = to_rgb(m_integral);
  m_product.sum_upwards(m_parent_slots);
  return m_product;
}

void SynchronousProduct::prepare_factors() {
  m_product.m_remaining.resize(m_factors.size());
  m_product.m_slots.resize(m_factors.size());
  m_slots.resize(m_factors.size());
  for (std::size_t i = 0; i < m_factors.size(); ++i) {
    Float4 others = {1, 1, 1, 0};
    for (std::size_t f = 0; f < m_factors.size(); ++f)
      if (f != i)
        others *= absolute(m_factors[f].mean());
    const TreeView* tree = m_factors[i].tree();
    m_product.m_remaining[i] = {tree != nullptr ? *tree : TreeView{}, others * product_floor};
    m_slots[i] = {nullptr, nullptr, others * product_floor, tree != nullptr ? -1 : 0};
  }
}

/// Allocates nodes and all that their quadrants may become.
void SynchronousProduct::make_room(std::size_t begin, std::size_t end) {
  grow(m_product.m_nodes, end);
  grow(m_parent_slots, end + 4 * (end - begin) + 4);
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    ProductTree::Slots& slots = m_product.m_slots[f];
    grow(slots.means, 4 * end);
    grow(slots.nodes, 4 * end);
    m_slots[f].means = slots.means.data();
    m_slots[f].nodes = slots.nodes.data();
  }
}

/// The root is always a node, even if nothing has detail.
void SynchronousProduct::start() {
  make_room(0, 1);
  m_node_count = 1;
  m_parent_slots[0] = 0;
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    const Float4 mean = m_factors[f].mean();
    const std::uint32_t root = m_factors[f].root();
    m_factors[f].split({m_parent_slots.data(), &mean, &root, 1},
                       {m_slots[f].means, m_slots[f].nodes});
  }
  add_quadrants(0, 1, 1);
}

/// @param level of the nodes' quadrants
void SynchronousProduct::split(std::size_t begin, std::size_t end, std::int32_t level) {
  for (std::size_t f = 0; f < m_factors.size(); ++f)
    m_factors[f].split(
        {m_parent_slots.data() + begin, m_slots[f].means, m_slots[f].nodes, end - begin},
        {m_slots[f].means + 4 * begin, m_slots[f].nodes + 4 * begin});
  add_quadrants(begin, end, level);
}

void SynchronousProduct::add_quadrants(std::size_t begin, std::size_t end, std::int32_t level) {
  SplitSquares squares;
  squares.factors = m_slots;
  squares.begin = begin;
  squares.end = end;
  squares.may_split = level < m_finest_level;
  squares.node_count = m_node_count;
  squares.product_nodes = m_product.m_nodes.data();
  squares.parent_slots = m_parent_slots.data();
  multiply_quadrants(squares);
  m_node_count = squares.node_count;
  m_integral += squares.leaf_sum * power_of_two(-2 * level);
}

} // namespace haarlight::wavelet
