// Practical product importance sampling, after Clarberg and Akenine-Möller 2008: at each point a
// quadtree of the reflectance is built from values in directions sampled from the reflectance, and
// multiplied by the light's averages over the same squares.

#include "samplers/basic_samplers.h"
#include "samplers/quadrant_tree.h"
#include "samplers/sampler_factories.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <array>

namespace haarlight::renderer {
namespace {

/// Floor of the reflectance relative to its mean, so that every direction has a density.
constexpr float reflectance_floor = 0.005F;

/// Bound on the radius of squares: this times 2^-level radians.
constexpr float square_radius = 4.4F;

constexpr std::uint32_t point_set = 0x50505333U;

/// A direction with a value of the reflectance, as a point of the light's square.
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

/// A square and its splats, [begin, end).
struct SplatSquare {
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

/// The direction in which a square's reflectance is evaluated, and its weight.
struct Evaluation {
  Vec3 direction;
  float weight = 1;
};

/// The centre of a square; if the horizon crosses the square, its highest corner with weight ½,
/// since the cosine decreases from there to 0.
Evaluation evaluation_of(const SplatSquare& square, const Vec3& n) {
  Evaluation evaluation = {square.center()};
  if (n.dot(evaluation.direction) > square_radius * square.side())
    return evaluation;
  float lowest = 1;
  Evaluation highest = {evaluation.direction, 0.5F};
  for (const auto& [u, v] : {std::pair(0.0F, 0.0F), {0.0F, 1.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}}) {
    const Vec3 corner = square.direction(u, v);
    lowest = std::min(lowest, n.dot(corner));
    if (n.dot(corner) > n.dot(highest.direction))
      highest.direction = corner;
  }
  return lowest < 0 ? highest : evaluation;
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
    evaluate_leaves(point, material);
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
  /// Evaluates directions sampled from the reflectance, sorted by Morton code.
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

  /// Splits squares until each contains at most one splat, with the light's averages.
  void grow() {
    m_nodes.clear();
    m_parent_slots.clear();
    m_squares.clear();
    m_pending.clear();
    SplatSquare root;
    root.end = static_cast<std::uint32_t>(m_splats.size());
    root.light = wavelet::to_lanes(m_light.mean);
    root.node = m_light.root();
    m_pending.push_back(root);
    while (!m_pending.empty()) {
      const SplatSquare square = m_pending.back();
      m_pending.pop_back();
      if (square.level == 0 || (square.end - square.begin > 1 && square.level < m_light.levels))
        split(square);
      else
        add_leaf(square);
    }
  }

  void split(const SplatSquare& square) {
    const auto node = static_cast<std::int32_t>(m_nodes.size());
    link(square, node);
    m_nodes.emplace_back();
    m_parent_slots.push_back(square.slot);
    const wavelet::TreeQuadrants light = m_light.split(square.node, square.light);
    SplatSquare quadrant = square;
    ++quadrant.level;
    for (unsigned q = 0; q < 4; ++q) {
      quadrant.slot = 4 * node + static_cast<std::int32_t>(q);
      quadrant.x = 2 * square.x + (q & 1U);
      quadrant.y = 2 * square.y + (q >> 1U);
      quadrant.begin = q == 0 ? square.begin : quadrant.end;
      quadrant.end = end_of_quadrant(quadrant.begin, square.end, quadrant.level, q);
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

  void link(const SplatSquare& square, std::int32_t child) {
    if (square.slot >= 0)
      m_nodes[static_cast<std::uint32_t>(square.slot) / 4].child[square.slot & 3] = child;
  }

  void add_leaf(const SplatSquare& square) {
    link(square, ~static_cast<std::int32_t>(m_squares.size()));
    m_squares.push_back(square);
  }

  /// A leaf's reflectance: the mean of its splats and of one further evaluation.
  void evaluate_leaves(const ShadingPoint& point, const Material& material) {
    m_directions.clear();
    m_evaluation_weights.clear();
    for (const SplatSquare& square : m_squares) {
      const Evaluation evaluation = evaluation_of(square, point.n);
      m_directions.push_back(evaluation.direction);
      m_evaluation_weights.push_back(evaluation.weight);
    }
    m_values.resize(m_directions.size());
    material.evaluate(point, m_directions, m_values);
    m_reflectance.resize(m_squares.size());
    for (std::size_t i = 0; i < m_squares.size(); ++i)
      m_reflectance[i] =
          mean_of(m_squares[i], wavelet::to_lanes(m_values[i]) * m_evaluation_weights[i]);
  }

  Float4 mean_of(const SplatSquare& square, Float4 evaluated) const {
    Float4 sum = evaluated;
    for (std::uint32_t i = square.begin; i < square.end; ++i)
      sum += m_splats[i].value;
    return sum / static_cast<float>(1 + square.end - square.begin);
  }

  /// Weights of the leaves, then of their ancestors.
  void multiply(const ShadingPoint& point) {
    Float4 floor = {};
    for (std::size_t i = 0; i < m_squares.size(); ++i)
      floor += m_reflectance[i] * (reflectance_floor * power_of_two(-2 * m_squares[i].level));
    m_leaves.resize(m_squares.size());
    for (std::size_t i = 0; i < m_squares.size(); ++i)
      set_leaf_weight(point, i, floor);
    for (std::size_t i = m_nodes.size(); i-- > 1;)
      set_weight(m_parent_slots[i], 0.25F * wavelet::lane_sum(m_nodes[i].weights));
    m_empty = !(wavelet::lane_sum(m_nodes[0].weights) > 0);
  }

  void set_leaf_weight(const ShadingPoint& point, std::size_t i, Float4 floor) {
    const SplatSquare& square = m_squares[i];
    const Float4 colours = larger(m_reflectance[i], floor) * wavelet::luminance_lanes;
    const float mean = wavelet::lane_sum(square.light * colours);
    const float height = point.n.dot(square.center());
    const bool visible = height > -square_radius * square.side();
    set_weight(square.slot, visible ? std::max(mean, 0.0F) : 0.0F);
    m_leaves[i] = {&m_light, square.node, mean, colours};
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
  std::vector<SplatSquare> m_pending;
  std::vector<SplatSquare> m_squares; ///< by leaf
  std::vector<float> m_evaluation_weights;
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
