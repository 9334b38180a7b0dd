#include <wavelet/product/projection.h>

#include "product/reflectance_quadrants.h"
#include "tree/tree_writer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Squares of this level are always evaluated: errors are relative to the mean, which is known from
/// them. The same as of adaptive products.
constexpr int first_level = 3;

/// Fraction of the tolerance, as a variance, that refinement may leave; the rest is for pruning.
/// Pruning drops coefficients that were evaluated at the cost of a look-up each, so that it gets
/// most.
constexpr double refinement_fraction = 0.25;

/// Factor of the threshold of splitting from pass to pass: the error per square falls by about as
/// much in a split.
constexpr float threshold_step = 0.25F;

/// Fraction of the mean that a square's brightness counts as at least, as for Criterion::Variance.
constexpr float darkest = 0.03F;

float luminance_of(Float4 c) { return lane_sum(c * luminance_lanes); }

} // namespace

std::vector<float> variances_within(const TreeView& tree) {
  std::vector<float> result(tree.node_count);
  for (std::uint32_t node = tree.node_count; node-- > 0;) {
    const Details d = tree.details(node);
    float sum = 0;
    for (const Float4& difference : {d.d1, d.d2, d.d3}) {
      const float y = luminance_of(difference);
      sum += y * y;
    }
    for (const std::uint32_t child : tree.children(node))
      sum += child == no_node ? 0 : 0.25F * result[child];
    result[node] = sum;
  }
  return result;
}

class ProductProjector::Projection {
public:
  explicit Projection(const ProjectionOptions& options) : m_options(options) {}

  Tree make(std::span<const ProjectionFactor> factors, const RotatedReflectance* reflectance);
  Rgb mean() const { return to_rgb(m_mean); }
  const ProjectionReport& report() const { return m_report; }

private:
  /// A square split into four. Slot 4 × node + q is quadrant q.
  struct Node {
    Square square;
    std::int32_t child[4] = {-1, -1, -1, -1}; ///< nodes, or −1
  };
  /// What one factor has in each slot.
  struct Slots {
    std::vector<Float4> means;
    std::vector<std::uint32_t> nodes;
  };
  /// Error added by pruning.
  struct Cost {
    float own = 0;   ///< by dropping this node's differences
    float under = 0; ///< and those of all nodes under it
  };

  void start();
  void refine();
  double split_above(float threshold);
  void add_node(const Square& square, std::int32_t slot);
  void split_factors(std::size_t node, std::int32_t slot);
  void look_up(std::size_t node);
  void multiply(std::size_t node);
  float error_of(std::size_t slot, int level) const;
  void sum_upwards();
  void find_costs();
  float choose_limit();
  Tree written(float limit);

  Float4 mean_of(std::size_t node) const { return mean_of_quadrants(m_products.data() + 4 * node); }
  Details details_of(std::size_t node) const {
    const auto d = differences_of_quadrants(m_products.data() + 4 * node);
    return {d[0], d[1], d[2]};
  }
  std::int32_t& child(std::int32_t slot) {
    return m_nodes[static_cast<std::size_t>(slot) / 4].child[slot & 3];
  }
  Square square(std::int32_t slot) const {
    const auto index = static_cast<std::uint32_t>(slot);
    return m_nodes[index / 4].square.quadrant(index & 3U);
  }

  ProjectionOptions m_options;
  std::span<const ProjectionFactor> m_factors;
  const RotatedReflectance* m_reflectance = nullptr;
  Float4 m_mean = {};
  float m_brightness = 0; ///< mean luminance so far
  std::vector<Node> m_nodes;
  std::vector<Slots> m_slots;         ///< by factor
  std::vector<Float4> m_reflectances; ///< by slot, lane 3 the deviation
  std::vector<Float4> m_products;     ///< by slot
  std::vector<float> m_errors;        ///< by slot
  std::vector<std::int32_t> m_open;   ///< slots that may be split
  std::vector<Cost> m_costs;
  std::vector<Cost> m_sorted;
  std::vector<std::int32_t> m_queue;
  ProjectionReport m_report;
};

Tree ProductProjector::Projection::make(std::span<const ProjectionFactor> factors,
                                        const RotatedReflectance* reflectance) {
  assert(factors.size() < 256 && m_options.levels >= 1 && m_options.levels <= 13);
  m_factors = factors;
  m_reflectance = reflectance;
  m_report = {};
  m_slots.resize(factors.size());
  start();
  refine();
  sum_upwards();
  find_costs();
  m_report.squares = 4 * m_nodes.size();
  return written(choose_limit());
}

void ProductProjector::Projection::start() {
  m_nodes.clear();
  m_open.clear();
  add_node({}, -1);
  m_brightness = luminance_of(mean_of(0));
  const int coarse = std::min(first_level, m_options.levels);
  for (std::size_t i = 0; i < m_open.size(); ++i) {
    const std::int32_t slot = m_open[i];
    if (square(slot).level < coarse)
      add_node(square(slot), slot);
  }
  std::erase_if(m_open, [&](std::int32_t slot) { return child(slot) >= 0; });
}

/// Splits the squares that leave most, then those that leave less, until the sum is small enough.
void ProductProjector::Projection::refine() {
  const double wanted = refinement_fraction * m_options.tolerance * m_options.tolerance;
  auto threshold = static_cast<float>(wanted / 16);
  while (!m_open.empty() && m_brightness > 0) {
    const double left = split_above(threshold * m_brightness) / static_cast<double>(m_brightness);
    if (left <= wanted)
      break;
    threshold *= threshold_step;
  }
}

/// @return the error of the squares that stay open
double ProductProjector::Projection::split_above(float threshold) {
  std::size_t kept = 0;
  double left = 0;
  for (std::size_t i = 0; i < m_open.size(); ++i) {
    const std::int32_t slot = m_open[i];
    if (m_errors[static_cast<std::size_t>(slot)] <= threshold) {
      left += static_cast<double>(m_errors[static_cast<std::size_t>(slot)]);
      m_open[kept++] = slot;
    } else {
      add_node(square(slot), slot);
    }
  }
  m_open.resize(kept);
  return left;
}

/// @param slot that the node comes from, −1 for the root
void ProductProjector::Projection::add_node(const Square& square, std::int32_t slot) {
  const std::size_t node = m_nodes.size();
  m_nodes.push_back({square});
  if (m_products.size() < 4 * node + 4) {
    const std::size_t room = std::max<std::size_t>(8 * node, 256);
    m_products.resize(room);
    m_errors.resize(room);
    m_reflectances.resize(room);
  }
  split_factors(node, slot);
  if (m_reflectance != nullptr)
    look_up(node);
  multiply(node);
  if (slot >= 0) {
    child(slot) = static_cast<std::int32_t>(node);
    m_brightness +=
        (luminance_of(mean_of(node)) - luminance_of(m_products[static_cast<std::size_t>(slot)])) *
        square.area();
  }
  if (square.level + 1 < m_options.levels)
    for (int q = 0; q < 4; ++q)
      m_open.push_back(static_cast<std::int32_t>(4 * node) + q);
}

void ProductProjector::Projection::split_factors(std::size_t node, std::int32_t slot) {
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    const TreeView& tree = m_factors[f].tree;
    Slots& slots = m_slots[f];
    if (slots.means.size() < m_products.size()) {
      slots.means.resize(m_products.size());
      slots.nodes.resize(m_products.size());
    }
    const auto from = static_cast<std::size_t>(slot);
    const TreeQuadrants quadrants = slot < 0 ? tree.split(tree.root(), to_lanes(tree.mean))
                                             : tree.split(slots.nodes[from], slots.means[from]);
    std::ranges::copy(quadrants.means, slots.means.data() + 4 * node);
    std::ranges::copy(quadrants.nodes, slots.nodes.data() + 4 * node);
  }
}

void ProductProjector::Projection::look_up(std::size_t node) {
  const RotatedReflectance& r = *m_reflectance;
  const Square& square = m_nodes[node].square;
  const Vec2 first = square.point(0.25F, 0.25F); // the quadrants' centres
  const float half = 0.5F * square.side();
  Float4 u = {first.x(), first.x() + half, first.x(), first.x() + half};
  Float4 v = {first.y(), first.y(), first.y() + half, first.y() + half};
  Float4 height;
  detail::rotate_point(r.reflection, u, v, height);
  Pyramid::Places places;
  for (int q = 0; q < 4; ++q) {
    places.u[q] = u[q];
    places.v[q] = v[q];
    r.pyramid->set_level(places, static_cast<std::size_t>(q), square.level + 1);
  }
  Pyramid::place(places, 4);
  for (std::size_t q = 0; q < 4; ++q)
    m_reflectances[4 * node + q] =
        r.pyramid->lookup(r.theta_index0, r.theta_index1, r.blend, places, q);
}

void ProductProjector::Projection::multiply(std::size_t node) {
  for (std::size_t slot = 4 * node; slot < 4 * node + 4; ++slot) {
    Float4 product = {1, 1, 1, 0};
    if (m_reflectance != nullptr)
      product *= m_reflectances[slot];
    for (const Slots& slots : m_slots)
      product *= slots.means[slot];
    m_products[slot] = larger(product, Float4{});
    m_errors[slot] = error_of(slot, m_nodes[node].square.level + 1);
  }
}

/// The error of a square that is not split, times the product's mean: its area times its variance
/// over its brightness. Relative variances of independent factors add up in (1 + a)(1 + b)… − 1.
float ProductProjector::Projection::error_of(std::size_t slot, int level) const {
  const float brightness = luminance_of(m_products[slot]);
  if (!(brightness > 0))
    return 0;
  float spread = 1;
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    const float mean = luminance_of(m_slots[f].means[slot]);
    const std::uint32_t node = m_slots[f].nodes[slot];
    if (node == no_node || !(mean > 0))
      continue;
    const float variance = m_factors[f].variances != nullptr ? m_factors[f].variances[node]
                                                             : std::max(mean * (1 - mean), 0.0F);
    spread *= 1 + variance / (mean * mean);
  }
  if (m_reflectance != nullptr) {
    const float mean = luminance_of(m_reflectances[slot]);
    const float deviation = m_reflectances[slot][3] / mean;
    spread *= 1 + deviation * deviation;
  }
  return power_of_two(-2 * level) * brightness * brightness * (spread - 1) /
         std::max(brightness, darkest * m_brightness);
}

/// Averages over all squares, children before parents, and the mean.
void ProductProjector::Projection::sum_upwards() {
  for (std::size_t node = m_nodes.size(); node-- > 0;)
    for (std::size_t q = 0; q < 4; ++q) {
      const std::int32_t child = m_nodes[node].child[q];
      if (child >= 0)
        m_products[4 * node + q] = mean_of(static_cast<std::size_t>(child));
      else if (m_nodes[node].square.level + 1 == m_options.levels)
        m_report.unresolved += static_cast<double>(m_errors[4 * node + q]);
      else
        m_report.dropped += static_cast<double>(m_errors[4 * node + q]);
    }
  m_mean = mean_of(0);
  m_brightness = luminance_of(m_mean);
  const double scale = m_brightness > 0 ? 1 / static_cast<double>(m_brightness) : 0;
  m_report.unresolved *= scale;
  m_report.dropped *= scale;
}

/// Dropping a node drops all nodes under it.
void ProductProjector::Projection::find_costs() {
  m_costs.resize(m_nodes.size());
  for (std::size_t node = m_nodes.size(); node-- > 0;) {
    const Details d = details_of(node);
    const Float4 squares = d.d1 * d.d1 + d.d2 * d.d2 + d.d3 * d.d3;
    const float brightness = luminance_of(mean_of(node));
    const float floor = std::max(brightness, darkest * m_brightness) * m_brightness;
    const float own = floor > 0 ? m_nodes[node].square.area() * luminance_of(squares) / floor : 0;
    float under = own;
    for (const std::int32_t child : m_nodes[node].child)
      under += child >= 0 ? m_costs[static_cast<std::size_t>(child)].under : 0;
    m_costs[node] = {own, under};
  }
}

/// The largest cost such that all nodes of this cost or less can be dropped together.
float ProductProjector::Projection::choose_limit() {
  const double budget = m_options.tolerance * m_options.tolerance;
  m_sorted = m_costs;
  std::sort(m_sorted.begin(), m_sorted.end(), [](const Cost& a, const Cost& b) {
    return a.under != b.under ? a.under < b.under : a.own < b.own;
  });
  float limit = 0;
  double dropped = m_report.dropped;
  for (std::size_t i = 0; i < m_sorted.size(); ++i) {
    dropped += static_cast<double>(m_sorted[i].own);
    if (dropped > budget)
      break;
    const bool last_of_its_cost =
        i + 1 == m_sorted.size() || m_sorted[i + 1].under > m_sorted[i].under;
    if (last_of_its_cost) {
      limit = m_sorted[i].under;
      m_report.dropped = dropped;
    }
  }
  return limit;
}

/// The nodes above the limit as a tree: breadth first, independent of the order of creation.
Tree ProductProjector::Projection::written(float limit) {
  const auto is_kept = [&](std::int32_t node) {
    return node >= 0 && m_costs[static_cast<std::size_t>(node)].under > limit;
  };
  float top = 0;
  for (std::size_t node = 0; node < m_nodes.size(); ++node)
    if (is_kept(static_cast<std::int32_t>(node)))
      top = std::max(top, largest_difference(details_of(node)));
  Tree tree;
  tree.levels = m_options.levels;
  tree.type = m_options.coefficients;
  tree.mean = to_rgb(m_mean);
  tree.scale = coefficient_scale(tree.type, top);
  TreeWriter writer(tree);
  m_queue.clear();
  if (is_kept(0))
    m_queue.push_back(0);
  for (std::size_t i = 0; i < m_queue.size(); ++i) {
    const auto node = static_cast<std::size_t>(m_queue[i]);
    std::uint32_t mask = 0;
    for (std::size_t q = 0; q < 4; ++q)
      if (const std::int32_t child = m_nodes[node].child[q]; is_kept(child)) {
        mask |= 1U << q;
        m_queue.push_back(child);
      }
    writer.add(mask, details_of(node));
  }
  writer.finish();
  return tree;
}

ProductProjector::ProductProjector(const ProjectionOptions& options)
    : m_projection(std::make_unique<Projection>(options)) {}
ProductProjector::~ProductProjector() = default;
ProductProjector::ProductProjector(ProductProjector&&) noexcept = default;
ProductProjector& ProductProjector::operator=(ProductProjector&&) noexcept = default;

Tree ProductProjector::make(std::span<const ProjectionFactor> factors,
                            const RotatedReflectance* reflectance) {
  return m_projection->make(factors, reflectance);
}
Rgb ProductProjector::mean() const { return m_projection->mean(); }
const ProjectionReport& ProductProjector::report() const { return m_projection->report(); }

} // namespace haarlight::wavelet
