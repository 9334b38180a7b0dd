// Wavelet importance sampling as published (Clarberg, Jarosz, Akenine-Möller and Jensen 2005): at
// each point the nearest entries of two tables, as hash tables of wavelet coefficients of
// luminance, are multiplied by the published algorithm, and points are warped down the product's
// tree.

#include "samplers/quadrant_tree.h"
#include "samplers/sampler_factories.h"
#include "samplers/table_cells.h"

#include <wavelet/reference/reference.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

namespace reference = wavelet::reference;
using wavelet::Square;
using Coefficients = reference::CoefficientSet<float>;
using Differences = Coefficients::Details;

/// F^1, F^2, F^3 of a square at a level, from averages over its quadrants.
Differences differences(const float (&c)[4], int level) {
  const float scale = 0.25F * power_of_two(-level);
  return {scale * (c[0] - c[1] + c[2] - c[3]), scale * (c[0] + c[1] - c[2] - c[3]),
          scale * (c[0] - c[1] - c[2] + c[3])};
}

void insert_nodes(const RollEntry& entry, std::uint32_t node, const Square& s, Coefficients& out) {
  if (node == wavelet::no_node)
    return;
  const auto stored = entry.tree.details(node).children(Float4{});
  float means[4];
  for (unsigned q = 0; q < 4; ++q)
    means[q] = wavelet::lane_sum(stored[entry.symmetry.to_stored(q)] * wavelet::luminance_lanes);
  out.details.emplace(s, differences(means, s.level));
  for (unsigned q = 0; q < 4; ++q)
    insert_nodes(entry, entry.tree.child(node, entry.symmetry.to_stored(q)), s.quadrant(q), out);
}

/// A table's entry as coefficients of luminance.
Coefficients coefficients_of(const RollEntry& entry) {
  Coefficients result;
  result.levels = entry.tree.levels;
  result.root = luminance(entry.tree.mean);
  insert_nodes(entry, entry.tree.root(), Square{}, result);
  return result;
}

/// A function's quadtree with averages clamped at 0, for warping.
class WarpTree {
public:
  void build(const Coefficients& function) {
    m_nodes.clear();
    m_squares.clear();
    m_places.clear();
    for (const auto& entry : function.details)
      node_of(entry.first);
    m_means.assign(m_nodes.size(), function.root);
    for (std::size_t i = 0; i < m_nodes.size(); ++i)
      set_quadrants(i, function.at(m_squares[i]));
    m_empty = !(function.root > 0);
  }

  bool empty() const { return m_empty; }

  /// Empty if the function is constant.
  std::span<const wavelet::ProductNode> nodes() const { return m_nodes; }

private:
  /// The node of a square; creates it after its ancestors if missing.
  std::size_t node_of(const Square& s) {
    if (const auto found = m_places.find(s); found != m_places.end())
      return found->second;
    const std::size_t above = s.level > 0 ? node_of(s.parent()) : 0;
    const std::size_t place = m_nodes.size();
    m_nodes.emplace_back();
    m_squares.push_back(s);
    m_places.emplace(s, place);
    if (s.level > 0)
      m_nodes[above].child[s.index_in_parent()] = static_cast<std::int32_t>(place);
    return place;
  }

  /// Sets the weights of a node's quadrants from its own average, which may be negative.
  void set_quadrants(std::size_t place, const Differences& d) {
    wavelet::ProductNode& node = m_nodes[place];
    const float scale = power_of_two(m_squares[place].level);
    const float d1 = scale * d[0];
    const float d2 = scale * d[1];
    const float d3 = scale * d[2];
    const Float4 means =
        m_means[place] + Float4{d1 + d2 + d3, -d1 + d2 - d3, d1 - d2 - d3, -d1 - d2 + d3};
    node.weights = larger(means, Float4{});
    if (!(wavelet::lane_sum(node.weights) > 0))
      node.weights = Float4{1, 1, 1, 1};
    for (unsigned q = 0; q < 4; ++q)
      if (node.child[q] >= 0)
        m_means[static_cast<std::size_t>(node.child[q])] = means[q];
  }

  std::vector<wavelet::ProductNode> m_nodes;
  std::vector<Square> m_squares; ///< by node
  std::vector<float> m_means;    ///< by node, not clamped
  std::unordered_map<Square, std::size_t, reference::SquareHash> m_places;
  bool m_empty = true;
};

class WaveletSampler : public Sampler {
public:
  explicit WaveletSampler(const Light& light) : m_table(*light.rotated_table()) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    const TableCells cells = nearest_cells(m_table, point, material);
    m_frame = entry_frame(m_table, cells);
    const Coefficients light =
        coefficients_of({m_table.tree(cells.light_column, cells.light_row), {}});
    const Coefficients lobe = coefficients_of(roll_entry(*material.roll_table(), cells));
    m_tree.build(reference::multiply(light, lobe));
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    if (m_tree.empty()) {
      std::ranges::fill(out, DirectionSample{Vec3::UnitZ(), 0});
      return;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      wavelet::Descent d;
      d.u1 = m_points[i].x();
      d.u2 = m_points[i].y();
      warp_down(m_tree.nodes(), d);
      out[i] = {m_frame.to_outer(wavelet::square_to_sphere(wavelet::end_point(d))),
                d.pdf / wavelet::sphere_area};
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    if (m_tree.empty())
      return 0;
    const Vec2 p = wavelet::sphere_to_square(m_frame.to_local(direction));
    wavelet::Descent d;
    warp_towards(m_tree.nodes(), p.x(), p.y(), d);
    return d.pdf / wavelet::sphere_area;
  }

  std::size_t leaves() const override { return m_tree.empty() ? 0 : 3 * m_tree.nodes().size() + 1; }

private:
  const TreeTable& m_table;
  Frame m_frame;
  WarpTree m_tree;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<SamplerFactory> make_wais_factory(const LoadedScene& scene,
                                                  const SamplerOptions& /*options*/) {
  return simple_factory<WaveletSampler>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
