#include <wavelet/product/projection.h>

#include <wavelet/base/cpu_clones.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Squares of this level are always looked at: the mean that errors are relative to comes from
/// them.
constexpr int first_level = 3;

/// The tolerance's share, as a variance, that refining may leave; the rest is for pruning.
constexpr double refining_share = 0.25;

/// How far the threshold of splitting falls from round to round.
constexpr float fall = 0.25F;

float luminance_of(Float4 c) { return lane_sum(c * luminance_lanes); }

/// Where the centres of a square's quadrants lie in the reflectance's square.
void rotate_centres(const ReflectionFrame& reflection, float u, float v, float half,
                    Pyramid::Places& places) {
  const Float4 us = {u, u + half, u, u + half};
  const Float4 vs = {v, v, v + half, v + half};
  Float4 wx = {};
  Float4 wy = {};
  Float4 wz = {};
  square_to_sphere(us, vs, wx, wy, wz);
  const auto along = [&](const Vec3& axis) {
    return axis.x() * wx + axis.y() * wy + axis.z() * wz;
  };
  Float4 pu = {};
  Float4 pv = {};
  sphere_to_square(along(reflection.frame.t), along(reflection.frame.b), along(reflection.frame.n),
                   pu, pv);
  for (int q = 0; q < 4; ++q) {
    places.u[q] = pu[q];
    places.v[q] = pv[q];
  }
}

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

Tree Projection::make(std::span<const ProjectionTerm> terms,
                      const RotatedReflectance* reflectance) {
  assert(terms.size() < 256 && m_options.levels >= 1 && m_options.levels <= 13);
  m_terms = terms;
  m_reflectance = reflectance;
  m_report = {};
  m_slots.resize(terms.size());
  start();
  refine();
  sum_upwards();
  find_costs();
  m_report.squares = 4 * m_nodes.size();
  return written(choose_limit());
}

void Projection::start() {
  m_nodes.clear();
  m_open.clear();
  add_node(0, 0, 0, -1);
  m_brightness = luminance_of(mean_of(0));
  const int coarse = std::min(first_level, m_options.levels);
  for (std::size_t i = 0; i < m_open.size(); ++i) {
    const std::int32_t slot = m_open[i];
    const Node node = m_nodes[static_cast<std::size_t>(slot) / 4];
    if (node.level + 1 < coarse)
      add_node(node.level + 1, 2U * node.x + (slot & 1), 2U * node.y + (slot >> 1 & 1), slot);
  }
  std::erase_if(m_open, [&](std::int32_t slot) {
    return m_nodes[static_cast<std::size_t>(slot) / 4].child[slot & 3] >= 0;
  });
}

/// Splits the squares that leave most, then those that leave less, until little is left in all.
void Projection::refine() {
  const double wanted = refining_share * m_options.tolerance * m_options.tolerance;
  auto threshold = static_cast<float>(wanted / 16);
  while (!m_open.empty() && m_brightness > 0) {
    const double left = split_above(threshold * m_brightness) / static_cast<double>(m_brightness);
    if (left <= wanted)
      break;
    threshold *= fall;
  }
}

/// @return what the open squares leave
double Projection::split_above(float threshold) {
  std::size_t kept = 0;
  double left = 0;
  for (std::size_t i = 0; i < m_open.size(); ++i) {
    const std::int32_t slot = m_open[i];
    if (m_errors[static_cast<std::size_t>(slot)] <= threshold) {
      left += static_cast<double>(m_errors[static_cast<std::size_t>(slot)]);
      m_open[kept++] = slot;
      continue;
    }
    const Node node = m_nodes[static_cast<std::size_t>(slot) / 4];
    add_node(node.level + 1, 2U * node.x + (slot & 1), 2U * node.y + (slot >> 1 & 1), slot);
  }
  m_open.resize(kept);
  return left;
}

/// @param slot that the node comes from, −1 for the root
void Projection::add_node(std::int32_t level, std::uint32_t x, std::uint32_t y, std::int32_t slot) {
  const std::size_t node = m_nodes.size();
  m_nodes.push_back(
      {level, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), {-1, -1, -1, -1}});
  if (m_products.size() < 4 * node + 4) {
    const std::size_t room = std::max<std::size_t>(8 * node, 256);
    m_products.resize(room);
    m_errors.resize(room);
    m_looked.resize(room);
    for (Slots& slots : m_slots) {
      slots.means.resize(room);
      slots.nodes.resize(room);
    }
  }
  split_terms(node, slot);
  if (m_reflectance != nullptr)
    look_up(node);
  multiply(node);
  if (slot >= 0) {
    m_nodes[static_cast<std::size_t>(slot) / 4].child[slot & 3] = static_cast<std::int32_t>(node);
    m_brightness +=
        (luminance_of(mean_of(node)) - luminance_of(m_products[static_cast<std::size_t>(slot)])) *
        power_of_two(-2 * level);
  }
  if (level + 1 < m_options.levels)
    for (int q = 0; q < 4; ++q)
      m_open.push_back(static_cast<std::int32_t>(4 * node) + q);
}

void Projection::split_terms(std::size_t node, std::int32_t slot) {
  for (std::size_t t = 0; t < m_terms.size(); ++t) {
    const TreeView& tree = m_terms[t].tree;
    Slots& slots = m_slots[t];
    if (slots.means.size() < m_products.size()) {
      slots.means.resize(m_products.size());
      slots.nodes.resize(m_products.size());
    }
    const Float4 mean =
        slot < 0 ? to_lanes(tree.mean) : slots.means[static_cast<std::size_t>(slot)];
    const std::uint32_t from = slot < 0 ? tree.root() : slots.nodes[static_cast<std::size_t>(slot)];
    if (from == no_node) {
      std::fill_n(slots.means.begin() + static_cast<std::ptrdiff_t>(4 * node), 4, mean);
      std::fill_n(slots.nodes.begin() + static_cast<std::ptrdiff_t>(4 * node), 4, no_node);
      continue;
    }
    const auto means = tree.details(from).children(mean);
    const auto children = tree.children(from);
    std::copy_n(means.begin(), 4, slots.means.begin() + static_cast<std::ptrdiff_t>(4 * node));
    std::copy_n(children.begin(), 4, slots.nodes.begin() + static_cast<std::ptrdiff_t>(4 * node));
  }
}

void Projection::look_up(std::size_t node) {
  const RotatedReflectance& r = *m_reflectance;
  const Node& n = m_nodes[node];
  const float side = power_of_two(-n.level);
  Pyramid::Places places;
  rotate_centres(r.reflection, (static_cast<float>(n.x) + 0.25F) * side,
                 (static_cast<float>(n.y) + 0.25F) * side, 0.5F * side, places);
  for (std::size_t q = 0; q < 4; ++q)
    r.pyramid->set_level(places, q, n.level + 1);
  Pyramid::place(places, 4);
  for (std::size_t q = 0; q < 4; ++q)
    m_looked[4 * node + q] = r.pyramid->lookup(r.entry0, r.entry1, r.blend, places, q);
}

void Projection::multiply(std::size_t node) {
  for (std::size_t slot = 4 * node; slot < 4 * node + 4; ++slot) {
    Float4 product = {1, 1, 1, 0};
    if (m_reflectance != nullptr)
      product *= m_looked[slot];
    for (const Slots& slots : m_slots)
      product *= slots.means[slot];
    m_products[slot] = larger(product, Float4{});
    m_errors[slot] = error_of(slot, m_nodes[node].level + 1);
  }
}

/// What a square leaves if it is not split, times the product's mean: its area times its variance
/// by its brightness. Relative variances of independent factors add up in (1 + a)(1 + b)… − 1.
float Projection::error_of(std::size_t slot, int level) const {
  const float brightness = luminance_of(m_products[slot]);
  if (!(brightness > 0))
    return 0;
  float spread = 1;
  for (std::size_t t = 0; t < m_terms.size(); ++t) {
    const float mean = luminance_of(m_slots[t].means[slot]);
    const std::uint32_t node = m_slots[t].nodes[slot];
    if (node == no_node || !(mean > 0))
      continue;
    const float variance = m_terms[t].variances != nullptr ? m_terms[t].variances[node]
                                                           : std::max(mean * (1 - mean), 0.0F);
    spread *= 1 + variance / (mean * mean);
  }
  if (m_reflectance != nullptr) {
    const float mean = luminance_of(m_looked[slot]);
    const float deviation = m_looked[slot][3] / mean;
    spread *= 1 + deviation * deviation;
  }
  return power_of_two(-2 * level) * brightness * brightness * (spread - 1) /
         std::max(brightness, darkest * m_brightness);
}

/// Averages over all squares, children before parents, and with them the mean.
void Projection::sum_upwards() {
  for (std::size_t node = m_nodes.size(); node-- > 0;)
    for (std::size_t q = 0; q < 4; ++q) {
      const std::int32_t child = m_nodes[node].child[q];
      if (child >= 0)
        m_products[4 * node + q] = mean_of(static_cast<std::size_t>(child));
      else if (m_nodes[node].level + 1 == m_options.levels)
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

Float4 Projection::mean_of(std::size_t node) const {
  const Float4* p = m_products.data() + 4 * node;
  return 0.25F * ((p[0] + p[1]) + (p[2] + p[3]));
}

Details Projection::details_of(std::size_t node) const {
  const Float4* p = m_products.data() + 4 * node;
  return {0.25F * ((p[0] + p[2]) - (p[1] + p[3])), 0.25F * ((p[0] + p[1]) - (p[2] + p[3])),
          0.25F * ((p[0] + p[3]) - (p[1] + p[2]))};
}

} // namespace haarlight::wavelet
