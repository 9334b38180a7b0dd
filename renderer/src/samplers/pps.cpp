// Practical product importance sampling, after Clarberg and Akenine-Möller 2008: a quadtree of the
// reflectance is made at each point from a few values of the reflectance itself, where importance
// sampling of it finds it large, and multiplied with the light's averages over the same squares.

#include "samplers/kinds.h"
#include "samplers/lobe_sampling.h"
#include "samplers/quadrant_tree.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <array>

namespace haarlight::renderer {
namespace {

/// The reflectance counts as at least this share of its mean, so that no direction is out of reach.
constexpr float reflectance_floor = 0.005F;

/// No square of level l reaches further than this times 2^-l radians from its centre.
constexpr float square_radius = 4.4F;

constexpr std::uint32_t point_set = 0x50505333U;

/// A direction that the reflectance is known in, as a point of the light's square.
struct Splat {
  std::uint32_t code = 0; ///< Morton, 16 bits of x and of y
  Float4 value = {};      ///< f_r cos, lanes R, G, B, 0
};

std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | (x << 8U)) & 0x00ff00ffU;
  x = (x | (x << 4U)) & 0x0f0f0f0fU;
  x = (x | (x << 2U)) & 0x33333333U;
  return (x | (x << 1U)) & 0x55555555U;
}

constexpr int code_levels = 16;

std::uint32_t morton_code(const Vec2& p) {
  const auto cell = [](float c) {
    return static_cast<std::uint32_t>(std::clamp(c, 0.0F, wavelet::detail::below_one) *
                                      power_of_two(code_levels));
  };
  return spread_bits(cell(p.x())) | (spread_bits(cell(p.y())) << 1U);
}

/// A square and the splats in it, [begin, end).
struct Region {
  std::int32_t slot = -1; ///< 4 × the parent's node + quadrant
  std::int32_t level = 0;
  std::uint32_t x = 0, y = 0;
  std::uint32_t begin = 0, end = 0;
  Float4 light = {}; ///< average radiance
  std::uint32_t node = wavelet::no_node;

  /// @param u,v in [0, 1]: where in the square
  Vec3 direction(float u, float v) const {
    return wavelet::square_to_sphere(
        Vec2((static_cast<float>(x) + u) * side(), (static_cast<float>(y) + v) * side()));
  }
  Vec3 center() const { return direction(0.5F, 0.5F); }
  float side() const { return power_of_two(-level); }
};

/// The direction that a square's reflectance is looked up in, and what it counts.
struct Look {
  Vec3 direction;
  float weight = 1;
};

/// The middle of a square; if the horizon cuts the square its highest corner, which counts half:
/// the cosine falls from there to 0.
Look look_at(const Region& region, const Vec3& n) {
  Look look = {region.center()};
  if (n.dot(look.direction) > square_radius * region.side())
    return look;
  float lowest = 1;
  Look highest = {look.direction, 0.5F};
  for (const auto& [u, v] : {std::pair(0.0F, 0.0F), {0.0F, 1.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}}) {
    const Vec3 corner = region.direction(u, v);
    lowest = std::min(lowest, n.dot(corner));
    if (n.dot(corner) > n.dot(highest.direction))
      highest.direction = corner;
  }
  return lowest < 0 ? highest : look;
}

class PracticalSampler : public Sampler {
public:
  PracticalSampler(const Light& light, int brdf_samples)
      : m_light(light.tree()), m_splats(static_cast<std::size_t>(brdf_samples)) {
    m_splat_points.resize(m_splats.size());
    m_splat_samples.resize(m_splats.size());
    fill_points(Points::Sobol, point_set, 0, m_splat_points);
  }

  void prepare(const ShadingPoint& point, const Material& material) override {
    splat(point, material);
    grow();
    value_leaves(point, material);
    multiply(point);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    if (m_empty) {
      std::ranges::fill(out, DirectionSample{Vec3::UnitZ(), 0});
      return;
    }
    m_points.resize(out.size());
    points.fill(2, m_points);
    m_densities.resize(out.size());
    m_descents.assign(out.size(), {});
    for (std::size_t i = 0; i < out.size(); ++i) {
      m_descents[i].u1 = m_points[i].x();
      m_descents[i].u2 = m_points[i].y();
      m_densities[i] = m_leaves[static_cast<std::size_t>(warp_down(m_nodes, m_descents[i]))];
    }
    wavelet::descend_tree(m_densities, m_descents);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {wavelet::square_to_sphere(wavelet::end_point(m_descents[i])),
                m_descents[i].pdf / wavelet::sphere_area};
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    const Vec2 p = wavelet::sphere_to_square(direction);
    wavelet::Descent d;
    const std::int32_t leaf = m_empty ? unreachable : warp_towards(m_nodes, p.x(), p.y(), d);
    if (leaf == unreachable)
      return 0;
    wavelet::follow_tree(m_leaves[static_cast<std::size_t>(leaf)], p.x(), p.y(), d);
    return d.pdf / wavelet::sphere_area;
  }

  std::size_t leaves() const override { return m_leaves.size(); }

private:
  /// Values in directions drawn from the reflectance, in the order of the squares they lie in.
  void splat(const ShadingPoint& point, const Material& material) {
    m_lobe.prepare(point, material);
    m_lobe.sample(m_splat_points, m_splat_samples);
    m_directions.clear();
    for (const DirectionSample& s : m_splat_samples)
      m_directions.push_back(s.direction);
    m_values.resize(m_directions.size());
    material.evaluate(point, m_directions, m_values);
    for (std::size_t i = 0; i < m_splats.size(); ++i)
      m_splats[i] = {morton_code(wavelet::sphere_to_square(m_directions[i])),
                     wavelet::to_lanes(m_values[i])};
    std::ranges::sort(m_splats, {}, &Splat::code);
  }

  /// Splits squares until none holds two splats, and the light's averages with them.
  void grow() {
    m_nodes.clear();
    m_parent_slots.clear();
    m_regions.clear();
    m_pending.clear();
    Region root;
    root.end = static_cast<std::uint32_t>(m_splats.size());
    root.light = wavelet::to_lanes(m_light.mean);
    root.node = m_light.root();
    m_pending.push_back(root);
    while (!m_pending.empty()) {
      const Region region = m_pending.back();
      m_pending.pop_back();
      if (region.level == 0 || (region.end - region.begin > 1 && region.level < m_light.levels))
        split(region);
      else
        add_leaf(region);
    }
  }

  void split(const Region& region) {
    const auto node = static_cast<std::int32_t>(m_nodes.size());
    link(region, node);
    m_nodes.emplace_back();
    m_parent_slots.push_back(region.slot);
    const wavelet::TreeQuadrants light = m_light.split(region.node, region.light);
    Region quadrant = region;
    ++quadrant.level;
    for (unsigned q = 0; q < 4; ++q) {
      quadrant.slot = 4 * node + static_cast<std::int32_t>(q);
      quadrant.x = 2 * region.x + (q & 1U);
      quadrant.y = 2 * region.y + (q >> 1U);
      quadrant.begin = q == 0 ? region.begin : quadrant.end;
      quadrant.end = end_of_quadrant(quadrant.begin, region.end, quadrant.level, q);
      quadrant.light = light.means[q];
      quadrant.node = light.nodes[q];
      m_pending.push_back(quadrant);
    }
  }

  std::uint32_t end_of_quadrant(std::uint32_t begin, std::uint32_t end, int level,
                                unsigned q) const {
    const auto shift = static_cast<unsigned>(2 * (code_levels - level));
    while (begin < end && (m_splats[begin].code >> shift & 3U) == q)
      ++begin;
    return begin;
  }

  void link(const Region& region, std::int32_t child) {
    if (region.slot >= 0)
      m_nodes[static_cast<std::uint32_t>(region.slot) / 4].child[region.slot & 3] = child;
  }

  void add_leaf(const Region& region) {
    link(region, ~static_cast<std::int32_t>(m_regions.size()));
    m_regions.push_back(region);
  }

  /// The reflectance over leaves: the mean of the splats there and of one look at it.
  void value_leaves(const ShadingPoint& point, const Material& material) {
    m_directions.clear();
    m_look_weights.clear();
    for (const Region& region : m_regions) {
      const Look look = look_at(region, point.n);
      m_directions.push_back(look.direction);
      m_look_weights.push_back(look.weight);
    }
    m_values.resize(m_directions.size());
    material.evaluate(point, m_directions, m_values);
    m_reflectance.resize(m_regions.size());
    for (std::size_t i = 0; i < m_regions.size(); ++i)
      m_reflectance[i] = mean_of(m_regions[i], wavelet::to_lanes(m_values[i]) * m_look_weights[i]);
  }

  Float4 mean_of(const Region& region, Float4 looked_up) const {
    Float4 sum = looked_up;
    for (std::uint32_t i = region.begin; i < region.end; ++i)
      sum += m_splats[i].value;
    return sum / static_cast<float>(1 + region.end - region.begin);
  }

  /// Weights of leaves, then of what lies above them.
  void multiply(const ShadingPoint& point) {
    Float4 floor = {};
    for (std::size_t i = 0; i < m_regions.size(); ++i)
      floor += m_reflectance[i] * (reflectance_floor * power_of_two(-2 * m_regions[i].level));
    m_leaves.resize(m_regions.size());
    for (std::size_t i = 0; i < m_regions.size(); ++i)
      weigh_leaf(point, i, floor);
    for (std::size_t i = m_nodes.size(); i-- > 1;)
      set_weight(m_parent_slots[i], 0.25F * wavelet::lane_sum(m_nodes[i].weights));
    m_empty = !(wavelet::lane_sum(m_nodes[0].weights) > 0);
  }

  void weigh_leaf(const ShadingPoint& point, std::size_t i, Float4 floor) {
    const Region& region = m_regions[i];
    const Float4 colours = larger(m_reflectance[i], floor) * wavelet::luminance_lanes;
    const float mean = wavelet::lane_sum(region.light * colours);
    const float height = point.n.dot(region.center());
    const bool visible = height > -square_radius * region.side();
    set_weight(region.slot, visible ? std::max(mean, 0.0F) : 0.0F);
    m_leaves[i] = {&m_light, region.node, mean, colours};
  }

  void set_weight(std::int32_t slot, float weight) {
    m_nodes[static_cast<std::uint32_t>(slot) / 4].weights[slot & 3] = weight;
  }

  wavelet::TreeView m_light;
  Lobe m_lobe;
  std::vector<Splat> m_splats;
  std::vector<Vec2> m_splat_points; ///< the same for every shading point
  std::vector<DirectionSample> m_splat_samples;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_values;
  std::vector<Region> m_pending;
  std::vector<Region> m_regions; ///< by leaf
  std::vector<float> m_look_weights;
  std::vector<Float4> m_reflectance;
  std::vector<wavelet::ProductNode> m_nodes; ///< parents before children
  std::vector<std::int32_t> m_parent_slots;
  std::vector<wavelet::TreeDensity> m_leaves;
  std::vector<Vec2> m_points;
  std::vector<wavelet::TreeDensity> m_densities;
  std::vector<wavelet::Descent> m_descents;
  bool m_empty = true;
};

} // namespace

std::unique_ptr<SamplerFactory> make_pps_factory(const LoadedScene& scene,
                                                 const SamplerOptions& options) {
  return simple_factory<PracticalSampler>(std::cref(scene.light()), options.pps_samples);
}

} // namespace haarlight::renderer
