#include <wavelet/product.h>
#include <wavelet/sphere_map.h>

#include <cmath>

namespace haarlight::wavelet {
namespace {

/// No square of level l reaches further than this times 2^-l radians from its centre.
constexpr float square_radius = 4.4F;

/// The reflectance counts as at least this share of its mean wherever light can come from, so that no
/// direction of the integrand is out of reach.
constexpr float reflectance_floor = 0.005F;

int morton_column(unsigned code) {
  return static_cast<int>((code & 1U) | ((code >> 1U) & 2U) | ((code >> 2U) & 4U));
}

} // namespace

AdaptiveProduct::AdaptiveProduct(const TreeView& light) : m_light(light) {
  // The families of level start_level − 1 and the nodes above them are the same for every product.
  for (unsigned code = 0; code < (1U << (2 * (start_level - 1))); ++code) {
    Family family = {to_lanes(light.mean), light.root(), 0, start_level - 1, morton_column(code),
                     morton_column(code >> 1U)};
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
  for (Family family : m_start) {
    family.product_node = product_node++;
    add_children(family, m_squares.size());
  }
}

/// The reflectance over the four quadrants of a family, and which of them see above the horizon.
void AdaptiveProduct::look_up(const Family& family, std::array<Float4, 4>& reflectance,
                              Int4& visible) const {
  const int level = family.level + 1;
  const float side = std::ldexp(1.0F, -level);
  const Float4 column = {0.5F, 1.5F, 0.5F, 1.5F};
  const Float4 row = {0.5F, 0.5F, 1.5F, 1.5F};
  const Float4 u = (column + static_cast<float>(2 * family.x)) * side;
  const Float4 v = (row + static_cast<float>(2 * family.y)) * side;
  Float4 wx;
  Float4 wy;
  Float4 wz;
  square_to_sphere(u, v, wx, wy, wz);
  const ReflectionFrame& r = m_reflectance.reflection;
  const Float4 x = r.frame.t.x() * wx + r.frame.t.y() * wy + r.frame.t.z() * wz;
  const Float4 y = r.frame.b.x() * wx + r.frame.b.y() * wy + r.frame.b.z() * wz;
  const Float4 z = r.frame.n.x() * wx + r.frame.n.y() * wy + r.frame.n.z() * wz;
  visible = r.sin_theta_r * x + r.cos_theta_r * z > Float4{} - square_radius * side;
  Float4 bu;
  Float4 bv;
  sphere_to_square(x, y, z, bu, bv);
  const Pyramid& pyramid = *m_reflectance.pyramid;
  const int looked_up = std::min(level, pyramid.levels());
  for (int q = 0; q < 4; ++q)
    if (visible[q] != 0) {
      const Float4 near = pyramid.lookup(m_reflectance.entry0, looked_up, bu[q], bv[q]);
      const Float4 far = pyramid.lookup(m_reflectance.entry1, looked_up, bu[q], bv[q]);
      reflectance[static_cast<std::size_t>(q)] = near + (far - near) * m_reflectance.blend;
    }
}

AdaptiveProduct::Square AdaptiveProduct::make_square(const Family& family, unsigned q, Float4 light,
                                                     Float4 reflectance) const {
  const int level = family.level + 1;
  const float deviation = reflectance[3];
  reflectance[3] = 0;
  const Float4 floored = larger(reflectance, m_floor);
  Square s;
  s.light = light;
  s.weights = floored * luminance_lanes;
  s.product = light * reflectance;
  s.node = m_light.child(family.node, q);
  s.slot = 4 * family.product_node + static_cast<std::int32_t>(q);
  s.level = level;
  s.x = 2 * family.x + static_cast<int>(q & 1U);
  s.y = 2 * family.y + static_cast<int>(q >> 1U);
  const float area = std::ldexp(1.0F, -2 * level);
  s.weight = area * std::max(lane_sum(light * s.weights), 0.0F);
  const float relative = deviation / (lane_sum(s.weights) + 1e-30F);
  s.error = level < m_reflectance.pyramid->levels() ? s.weight * relative * relative : 0.0F;
  return s;
}

/// Adds a family's visible quadrants; the first takes the place `reuse`, the rest are appended.
void AdaptiveProduct::add_children(const Family& family, std::size_t reuse) {
  std::array<Float4, 4> reflectance;
  Int4 visible;
  look_up(family, reflectance, visible);
  std::array<Float4, 4> light = {family.light, family.light, family.light, family.light};
  if (family.node != no_node)
    light = m_light.details(family.node).children(family.light);
  for (unsigned q = 0; q < 4; ++q) {
    if (visible[q] == 0)
      continue;
    const Square square = make_square(family, q, light[q], reflectance[q]);
    m_weight += static_cast<double>(square.weight);
    m_error += static_cast<double>(square.error);
    if (reuse < m_squares.size()) {
      m_squares[reuse] = square;
      reuse = m_squares.size();
    } else {
      m_squares.push_back(square);
      reuse = m_squares.size();
    }
  }
  if (reuse < m_squares.size()) { // nothing was visible: the place is empty
    m_squares[reuse].weight = m_squares[reuse].error = 0;
    m_squares[reuse].product = Float4{};
    m_squares[reuse].slot = -1;
  }
}

void AdaptiveProduct::split(std::size_t index) {
  const Square square = m_squares[index];
  const auto product_node = static_cast<std::int32_t>(m_product.m_nodes.size());
  m_weight -= static_cast<double>(square.weight);
  m_error -= static_cast<double>(square.error);
  m_product.m_nodes.emplace_back();
  m_product.m_nodes[static_cast<std::size_t>(square.slot / 4)].child[square.slot % 4] = product_node;
  m_parent_slots.push_back(square.slot);
  add_children({square.light, square.node, product_node, square.level, square.x, square.y}, index);
}

/// Pass by pass, splits every square whose error is at least the mean of the pass, and its quadrants
/// with it, until the bound holds.
void AdaptiveProduct::refine(const AdaptiveOptions& options) {
  const auto limit = static_cast<std::size_t>(options.max_leaves);
  const auto bound = static_cast<double>(options.variance_bound);
  while (m_error > bound * m_weight && m_squares.size() + 3 <= limit) {
    const auto threshold =
        static_cast<float>(0.999 * m_error / static_cast<double>(m_squares.size()));
    bool any = false;
    for (std::size_t i = 0; i < m_squares.size(); ++i)
      while (m_squares[i].error > threshold && m_squares.size() + 3 <= limit) {
        split(i);
        any = true;
      }
    if (!any)
      break;
  }
}

void AdaptiveProduct::finish() {
  Float4 integral = {};
  m_product.m_leaves.clear();
  for (const Square& s : m_squares) {
    if (s.slot < 0)
      continue;
    ProductNode& parent = m_product.m_nodes[static_cast<std::size_t>(s.slot / 4)];
    const float area = std::ldexp(1.0F, -2 * s.level);
    parent.weights[s.slot % 4] = s.weight / area;
    parent.child[s.slot % 4] = ~static_cast<std::int32_t>(m_product.m_leaves.size());
    m_product.m_leaves.push_back({&m_light, s.node, s.light, s.weights});
    integral += s.product * area;
  }
  m_product.m_integral = to_rgb(integral);
  m_product.sum_upwards(m_parent_slots);
}

} // namespace haarlight::wavelet
