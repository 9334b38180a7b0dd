#include <wavelet/product.h>
#include <wavelet/sphere_map.h>

#include <numeric>

namespace haarlight::wavelet {
namespace {

/// No square of level l reaches further than this times 2^-l radians from its centre.
constexpr float square_radius = 4.4F;

/// The reflectance counts as at least this share of its mean wherever light can come from, so that
/// no direction of the integrand is out of reach.
constexpr float reflectance_floor = 0.005F;

int morton_column(unsigned code) {
  return static_cast<int>((code & 1U) | ((code >> 1U) & 2U) | ((code >> 2U) & 4U));
}

} // namespace

AdaptiveProduct::AdaptiveProduct(const TreeView& light) : m_light(light) {
  m_product.m_light = light;
  // The families of level start_level − 1 and the nodes above them are the same for every product.
  for (unsigned code = 0; code < (1U << (2 * (start_level - 1))); ++code) {
    Family family = {
        to_lanes(light.mean),      light.root(), 0, start_level - 1, morton_column(code),
        morton_column(code >> 1U), no_place};
    for (int l = start_level - 2; l >= 0; --l) {
      const unsigned q = (code >> static_cast<unsigned>(2 * l)) & 3U;
      if (family.node != no_node)
        family.light = light.details(family.node).children(family.light)[q];
      family.node = light.child(family.node, q);
    }
    m_start.push_back(family);
  }
}

const ProductTree& AdaptiveProduct::build(const RotatedReflectance& reflectance,
                                          const AdaptiveOptions& options) {
  m_reflectance = reflectance;
  const Pyramid& pyramid = *reflectance.pyramid;
  const Float4 mean = pyramid.lookup(reflectance.entry0, 0, 0.5F, 0.5F);
  m_floor = larger(mean * reflectance_floor, Float4{});
  m_floor[3] = 0;
  start();
  refine(options);
  finish();
  return m_product;
}

/// Lays out the nodes above start_level and looks at every family there.
void AdaptiveProduct::start() {
  m_squares.clear();
  m_parent_slots.clear();
  m_product.m_nodes.clear();
  m_weight = 0;
  m_error = 0;
  std::int32_t first = 0;
  for (int level = 0, count = 1; level < start_level; ++level, count *= 4) {
    for (std::int32_t i = 0; i < count; ++i) {
      m_parent_slots.push_back(level == 0 ? -1 : 4 * (first - count / 4 + i / 4) + i % 4);
      ProductNode node;
      if (level + 1 < start_level)
        for (std::int32_t q = 0; q < 4; ++q)
          node.child[q] = first + count + 4 * i + q;
      m_product.m_nodes.push_back(node);
    }
    first += count;
  }
  auto product_node = static_cast<std::int32_t>(m_product.m_nodes.size() - m_start.size());
  m_families = m_start;
  for (Family& family : m_families)
    family.product_node = product_node++;
  expand(m_families);
}

/// Where the quadrants of a family lie in the reflectance's frame.
void AdaptiveProduct::place(const Family& family, Quadrants& quadrants) const {
  const int level = family.level + 1;
  const float side = power_of_two(-level);
  const Float4 column = {0.5F, 1.5F, 0.5F, 1.5F};
  const Float4 row = {0.5F, 0.5F, 1.5F, 1.5F};
  Float4 wx;
  Float4 wy;
  Float4 wz;
  square_to_sphere((column + static_cast<float>(2 * family.x)) * side,
                   (row + static_cast<float>(2 * family.y)) * side, wx, wy, wz);
  const ReflectionFrame& r = m_reflectance.reflection;
  const Float4 x = r.frame.t.x() * wx + r.frame.t.y() * wy + r.frame.t.z() * wz;
  const Float4 y = r.frame.b.x() * wx + r.frame.b.y() * wy + r.frame.b.z() * wz;
  const Float4 z = r.frame.n.x() * wx + r.frame.n.y() * wy + r.frame.n.z() * wz;
  quadrants.visible = r.sin_theta_r * x + r.cos_theta_r * z > Float4{} - square_radius * side;
  Float4 u;
  Float4 v;
  sphere_to_square(x, y, z, u, v);
  quadrants.places =
      m_reflectance.pyramid->places(std::min(level, m_reflectance.pyramid->levels()), u, v);
}

/// The reflectance over the quadrants; 0 below the horizon.
void AdaptiveProduct::look_up(Quadrants& quadrants) const {
  const Pyramid& pyramid = *m_reflectance.pyramid;
  for (int q = 0; q < 4; ++q) {
    Float4& value = quadrants.reflectance[static_cast<std::size_t>(q)];
    value = Float4{};
    if (quadrants.visible[q] == 0)
      continue;
    const Float4 near = pyramid.lookup(m_reflectance.entry0, quadrants.places, q);
    const Float4 far = pyramid.lookup(m_reflectance.entry1, quadrants.places, q);
    value = near + (far - near) * m_reflectance.blend;
  }
}

/// What each quadrant adds to the total, and to the variance if it stays a leaf.
void AdaptiveProduct::weigh(const Family& family, Quadrants& quadrants) const {
  const int level = family.level + 1;
  auto [lr, lg, lb, l0] = quadrants.light;
  auto [br, bg, bb, deviation] = quadrants.reflectance;
  transpose(lr, lg, lb, l0);
  transpose(br, bg, bb, deviation);
  const Float4 zero = {};
  const Float4 r = larger(br, zero + m_floor[0]) * luminance_lanes[0];
  const Float4 g = larger(bg, zero + m_floor[1]) * luminance_lanes[1];
  const Float4 b = larger(bb, zero + m_floor[2]) * luminance_lanes[2];
  const Float4 density = larger(lr * r + lg * g + lb * b, zero);
  const Float4 relative = deviation / (r + g + b + 1e-30F);
  quadrants.weight = density * power_of_two(-2 * level);
  quadrants.error =
      level < m_reflectance.pyramid->levels() ? quadrants.weight * relative * relative : zero;
}

/// Adds a family's visible quadrants; the first takes the family's place, the rest are appended.
void AdaptiveProduct::add(const Family& family, const Quadrants& quadrants) {
  std::uint32_t place = family.place;
  for (unsigned q = 0; q < 4; ++q) {
    if (quadrants.visible[q] == 0)
      continue;
    if (place == no_place) {
      place = static_cast<std::uint32_t>(m_squares.size());
      m_squares.emplace_back();
    }
    Square& s = m_squares[place];
    m_added.push_back(place);
    place = no_place;
    s.light = quadrants.light[q];
    s.reflectance = quadrants.reflectance[q];
    s.node = m_light.child(family.node, q);
    s.slot = 4 * family.product_node + static_cast<std::int32_t>(q);
    s.x = static_cast<std::uint16_t>(2 * family.x + static_cast<int>(q & 1U));
    s.y = static_cast<std::uint16_t>(2 * family.y + static_cast<int>(q >> 1U));
    s.level = family.level + 1;
    s.weight = quadrants.weight[q];
    s.error = quadrants.error[q];
  }
  if (place != no_place) { // nothing was visible: the place is empty
    m_squares[place].weight = m_squares[place].error = 0;
    m_squares[place].slot = -1;
  }
  m_weight += static_cast<double>(lane_sum(quadrants.weight));
  m_error += static_cast<double>(lane_sum(quadrants.error));
}

void AdaptiveProduct::expand(std::span<const Family> families) {
  std::array<Quadrants, batch_size> batch;
  for (std::size_t begin = 0; begin < families.size(); begin += batch_size) {
    const std::size_t count = std::min(batch_size, families.size() - begin);
    const Family* family = families.data() + begin;
    for (std::size_t i = 0; i < count; ++i)
      place(family[i], batch[i]);
    for (std::size_t i = 0; i < count; ++i)
      look_up(batch[i]);
    for (std::size_t i = 0; i < count; ++i) {
      batch[i].light.fill(family[i].light);
      if (family[i].node != no_node)
        batch[i].light = m_light.details(family[i].node).children(family[i].light);
      weigh(family[i], batch[i]);
    }
    for (std::size_t i = 0; i < count; ++i)
      add(family[i], batch[i]);
  }
}

/// Makes a product node of a square.
AdaptiveProduct::Family AdaptiveProduct::split(std::uint32_t index) {
  const Square& s = m_squares[index];
  const auto product_node = static_cast<std::int32_t>(m_product.m_nodes.size());
  m_weight -= static_cast<double>(s.weight);
  m_error -= static_cast<double>(s.error);
  m_product.m_nodes.emplace_back();
  m_product.m_nodes[static_cast<std::size_t>(s.slot / 4)].child[s.slot % 4] = product_node;
  m_parent_slots.push_back(s.slot);
  return {s.light, s.node, product_node, s.level, s.x, s.y, index};
}

/// Pass by pass, splits every square whose error is above the mean of the pass, and its quadrants
/// with it, until the bound holds.
void AdaptiveProduct::refine(const AdaptiveOptions& options) {
  const auto limit = static_cast<std::size_t>(options.max_leaves);
  const auto bound = static_cast<double>(options.variance_bound);
  std::size_t before = 0;
  while (m_error > bound * m_weight && m_squares.size() != before) {
    before = m_squares.size();
    m_fresh.resize(before);
    std::iota(m_fresh.begin(), m_fresh.end(), 0U);
    refine_above(static_cast<float>(0.999 * m_error / static_cast<double>(before)), limit);
  }
}

void AdaptiveProduct::refine_above(float threshold, std::size_t limit) {
  while (true) {
    m_families.clear();
    for (const std::uint32_t index : m_fresh)
      if (m_squares[index].error > threshold && m_squares.size() + 3 * m_families.size() < limit)
        m_families.push_back(split(index));
    if (m_families.empty())
      return;
    m_added.clear();
    expand(m_families);
    m_fresh.swap(m_added);
  }
}

void AdaptiveProduct::finish() {
  Float4 integral = {};
  m_product.m_leaves.clear();
  for (const Square& s : m_squares) {
    if (s.slot < 0)
      continue;
    const float area = power_of_two(-2 * s.level);
    ProductNode& parent = m_product.m_nodes[static_cast<std::size_t>(s.slot / 4)];
    parent.weights[s.slot % 4] = s.weight / area;
    parent.child[s.slot % 4] = ~static_cast<std::int32_t>(m_product.m_leaves.size());
    const Float4 weights = larger(s.reflectance, m_floor) * luminance_lanes;
    m_product.m_leaves.push_back({s.light, weights, s.node});
    integral += s.light * s.reflectance * area;
  }
  m_product.m_integral = to_rgb(integral);
  m_product.sum_upwards(m_parent_slots);
}

} // namespace haarlight::wavelet
