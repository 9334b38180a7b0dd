// Two-stage importance sampling (Cline, Egbert, Talbot and Cardon 2006): at each point the probe's
// picture is partitioned by the reflectance, a region is chosen by the product of light and
// reflectance, and a place in it by the light's summed-area table.

#include "samplers/basic_samplers.h"
#include "samplers/sampler_factories.h"

#include <probe/probe.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace haarlight::renderer {
namespace {

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1.
struct PixelRange {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }

  /// Where the range is divided: between pixels.
  int middle_x() const { return (x0 + x1) / 2; }
  int middle_y() const { return (y0 + y1) / 2; }

  /// Quarter i: (left, top), (right, top), (left, bottom), (right, bottom).
  PixelRange quarter(int i) const {
    const int x = middle_x();
    const int y = middle_y();
    return {i % 2 == 0 ? x0 : x, i < 2 ? y0 : y, i % 2 == 0 ? x : x1, i < 2 ? y : y1};
  }
};

/// A position along the pixels of a row or column.
struct PixelPosition {
  int index = 0;
  double fraction = 0; ///< within the pixel, in [0, 1)
};

/// Inverts a cumulative sum. @param sum_up_to sum before a given index; 0 at `begin`, nondecreasing
template <class Sum>
PixelPosition invert_sum(int begin, int end, double u, Sum sum_up_to) {
  const double target = u * static_cast<double>(sum_up_to(end));
  int low = begin;
  int high = end;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (static_cast<double>(sum_up_to(middle)) <= target ? low : high) = middle;
  }
  const auto before = static_cast<double>(sum_up_to(low));
  const auto width = static_cast<double>(sum_up_to(high)) - before;
  return {low, width > 0 ? std::min((target - before) / width, 0x1.fffffep-1) : 0.5};
}

/// A summed-area table of a probe's pixels (Crow 1984). A pixel's light is its luminance times its
/// solid angle as an integer number of units, at least one for every pixel that is not black: sums
/// are exact, and so are the densities of what is drawn. Shared by threads.
class SummedLight {
public:
  explicit SummedLight(const probe::Probe& probe)
      : m_mapping(probe.mapping()), m_width(probe.width()), m_height(probe.height()),
        m_sums(static_cast<std::size_t>(m_width + 1) * static_cast<std::size_t>(m_height + 1)) {
    constexpr double all_units = 0x1p52; // approximate total, exact as double too
    const auto width = static_cast<std::size_t>(m_width);
    std::vector<double> light(width * static_cast<std::size_t>(m_height));
    parallel_for(static_cast<std::size_t>(m_height), [&](std::size_t y) {
      for (int x = 0; x < m_width; ++x)
        light[y * width + static_cast<std::size_t>(x)] =
            probe.mean_luminance(x, static_cast<int>(y)) *
            probe.pixel_solid_angle(x, static_cast<int>(y));
    });
    const double total = std::accumulate(light.begin(), light.end(), 0.0);
    const double scale = total > 0 ? all_units / total : 0;
    for (std::size_t y = 0; y < static_cast<std::size_t>(m_height); ++y) {
      std::uint64_t row = 0;
      for (std::size_t x = 0; x < width; ++x) {
        const double units = light[y * width + x] * scale;
        row += units > 0 ? std::max<std::uint64_t>(1, static_cast<std::uint64_t>(units)) : 0;
        m_sums[(y + 1) * (width + 1) + x + 1] = m_sums[y * (width + 1) + x + 1] + row;
      }
    }
  }

  probe::Mapping mapping() const { return m_mapping; }
  PixelRange all() const { return {0, 0, m_width, m_height}; }

  /// Light of a range, in units.
  std::uint64_t sum(const PixelRange& r) const {
    return at(r.x1, r.y1) - at(r.x0, r.y1) - at(r.x1, r.y0) + at(r.x0, r.y0);
  }

  /// The pixel that contains an image point.
  PixelRange pixel(const Vec2& uv) const {
    const auto index = [](float coordinate, int size) {
      return std::min(static_cast<int>(coordinate * static_cast<float>(size)), size - 1);
    };
    const int x = index(uv.x(), m_width);
    const int y = index(uv.y(), m_height);
    return {x, y, x + 1, y + 1};
  }

  /// Inverts the cdf of the columns of a range with u, that of the chosen column with v; uniform
  /// within a pixel. @param u,v in [0, 1) @return a point of the image, in [0, 1]², and its pixel
  std::pair<Vec2, PixelRange> draw(const PixelRange& r, double u, double v) const {
    const PixelPosition column = invert_sum(r.x0, r.x1, u, [&](int x) {
      return sum({r.x0, r.y0, x, r.y1});
    });
    const int x = column.index;
    const PixelPosition row = invert_sum(r.y0, r.y1, v, [&](int y) {
      return sum({x, r.y0, x + 1, y});
    });
    const int y = row.index;
    return {Vec2(static_cast<float>((x + column.fraction) / m_width),
                 static_cast<float>((y + row.fraction) / m_height)),
            {x, y, x + 1, y + 1}};
  }

private:
  std::uint64_t at(int x, int y) const {
    return m_sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(m_width + 1) +
                  static_cast<std::size_t>(x)];
  }

  probe::Mapping m_mapping;
  int m_width;
  int m_height;
  std::vector<std::uint64_t> m_sums; ///< of all pixels above and to the left
};

/// Chooses the second of two parts if u lies beyond the first, and rescales u within the chosen
/// one.
bool choose_second(double first, double second, double& u) {
  const double place = u * (first + second);
  const bool is_second = place >= first;
  u = is_second ? (place - first) / second : place / first;
  u = std::min(u, 0x1.fffffep-1);
  return is_second;
}

/// A quadtree of rectangles of the picture. The mean of f_r cos (luminance) over each is estimated
/// from its corners, its centre and the probing directions inside; the rectangle with the largest
/// range of values times light is divided next. Densities are exactly those of the descent.
class LightPartition {
public:
  explicit LightPartition(const SummedLight& light) : m_light(light) {}

  /// @param probes  directions in which the reflectance may have a peak between the corners
  /// @param regions undivided rectangles at most, 4 or more
  void build(const ShadingPoint& point, const Material& material, std::span<const Vec3> probes,
             std::size_t regions) {
    m_point = &point;
    m_material = &material;
    m_directions.assign(probes.begin(), probes.end());
    evaluate();
    m_probes.resize(probes.size());
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const PixelRange pixel =
          m_light.pixel(probe::direction_to_image(m_light.mapping(), probes[i]));
      m_probes[i] = {pixel.x0, pixel.y0, m_reflected[i]};
    }
    add_root();
    while (!m_queue.empty() && this->regions() + 3 * batch <= regions &&
           m_error > tolerable_error * m_product)
      split_batch();
    sum_products();
  }

  /// Warps a point of the unit square through the tree, then through the light of the region.
  /// @param density receives the density, sr⁻¹; 0 if the point is no direction
  /// @return a point of the image
  Vec2 sample(const Vec2& point, float& density) const {
    auto u = static_cast<double>(point.x());
    auto v = static_cast<double>(point.y());
    const Node* node = m_nodes.data();
    while (node->child >= 0) {
      const Node* const c = &m_nodes[static_cast<std::size_t>(node->child)];
      const int right =
          choose_second(c[0].product + c[2].product, c[1].product + c[3].product, u) ? 1 : 0;
      const int below = choose_second(c[right].product, c[right + 2].product, v) ? 2 : 0;
      node = c + right + below;
    }
    const auto [uv, pixel] = m_light.draw(node->range, u, v);
    density = probe::in_map(m_light.mapping(), uv) ? density_in(*node, pixel, uv) : 0.0F;
    return uv;
  }

  /// Density of sample() at an image point, sr⁻¹.
  float pdf(const Vec2& uv) const {
    const PixelRange pixel = m_light.pixel(uv);
    const Node* node = m_nodes.data();
    while (node->child >= 0) {
      const std::size_t right = pixel.x0 >= node->range.middle_x() ? 1 : 0;
      const std::size_t below = pixel.y0 >= node->range.middle_y() ? 2 : 0;
      node = &m_nodes[static_cast<std::size_t>(node->child) + right + below];
    }
    return density_in(*node, pixel, uv);
  }

  std::size_t regions() const { return 1 + (m_nodes.size() - 1) / 4 * 3; }

private:
  static constexpr std::size_t batch = 8; ///< rectangles divided at a time
  static constexpr std::size_t points_per_split = 8;
  static constexpr double tolerable_error = 0.25; ///< range of values, relative to the product
  static constexpr double floor_fraction = 0.05; ///< of samples, about, that follow the light alone

  struct Values {
    float corner[4] = {}; ///< (x0, y0), (x1, y0), (x0, y1), (x1, y1)
    float centre = 0;
  };
  struct Node {
    PixelRange range;
    Values values;
    double light = 0;
    double product = 0;
    float mean = 0; ///< estimate of f_r cos
    int child = -1; ///< first of four quarters; −1 undivided
  };
  struct Entry {
    double error;
    int node;
    bool operator<(const Entry& other) const { return error < other.error; }
  };
  struct Probe {
    int x = 0; ///< pixel
    int y = 0;
    float value = 0;
  };

  void request(float x, float y) {
    const Vec2 uv(x / static_cast<float>(m_light.all().x1),
                  y / static_cast<float>(m_light.all().y1));
    m_directions.push_back(probe::image_to_direction(m_light.mapping(), uv));
  }

  /// Where the range would be divided, or the middle of the only pixel.
  void request_centre(const PixelRange& r) {
    request(r.width() > 1 ? static_cast<float>(r.middle_x()) : static_cast<float>(r.x0) + 0.5F,
            r.height() > 1 ? static_cast<float>(r.middle_y()) : static_cast<float>(r.y0) + 0.5F);
  }

  /// Sets m_reflected to f_r cos in the requested directions.
  void evaluate() {
    m_values.resize(m_directions.size());
    m_reflected.resize(m_directions.size());
    m_material->evaluate(*m_point, m_directions, m_values);
    for (std::size_t i = 0; i < m_values.size(); ++i)
      m_reflected[i] = luminance(m_values[i]);
    m_directions.clear();
  }

  void add_root() {
    m_nodes.clear();
    m_queue.clear();
    m_error = 0;
    m_product = 0;
    const PixelRange all = m_light.all();
    for (int i = 0; i < 4; ++i)
      request(static_cast<float>(i % 2 == 0 ? all.x0 : all.x1),
              static_cast<float>(i < 2 ? all.y0 : all.y1));
    request_centre(all);
    evaluate();
    Values values;
    std::copy_n(m_reflected.begin(), 4, values.corner);
    values.centre = m_reflected[4];
    add(all, values);
  }

  void split_batch() {
    m_batch.clear();
    while (m_batch.size() < batch && !m_queue.empty()) {
      std::pop_heap(m_queue.begin(), m_queue.end());
      const Entry entry = m_queue.back();
      m_queue.pop_back();
      const Node& node = m_nodes[static_cast<std::size_t>(entry.node)];
      m_error -= entry.error;
      m_product -= node.light * static_cast<double>(node.mean);
      m_batch.push_back(entry.node);
      request_split(node.range);
    }
    evaluate();
    for (std::size_t i = 0; i < m_batch.size(); ++i)
      split(m_batch[i], std::span(m_reflected).subspan(i * points_per_split, points_per_split));
  }

  /// The middles of the sides (top, left, right, bottom) and the centres of the quarters.
  void request_split(const PixelRange& r) {
    const auto x = static_cast<float>(r.middle_x());
    const auto y = static_cast<float>(r.middle_y());
    request(x, static_cast<float>(r.y0));
    request(static_cast<float>(r.x0), y);
    request(static_cast<float>(r.x1), y);
    request(x, static_cast<float>(r.y1));
    for (int i = 0; i < 4; ++i)
      request_centre(r.quarter(i));
  }

  /// @param side values of request_split()
  void split(int index, std::span<const float> side) {
    const Node node = m_nodes[static_cast<std::size_t>(index)];
    const float* const c = node.values.corner;
    const float m = node.values.centre;
    const float corners[4][4] = {{c[0], side[0], side[1], m},
                                 {side[0], c[1], m, side[2]},
                                 {side[1], m, c[2], side[3]},
                                 {m, side[2], side[3], c[3]}};
    m_nodes[static_cast<std::size_t>(index)].child = static_cast<int>(m_nodes.size());
    for (int i = 0; i < 4; ++i) {
      Values values;
      std::copy_n(corners[i], 4, values.corner);
      values.centre = side[4 + static_cast<std::size_t>(i)];
      add(node.range.quarter(i), values);
    }
  }

  void add(const PixelRange& range, const Values& values) {
    Node node;
    node.range = range;
    node.values = values;
    node.light = static_cast<double>(m_light.sum(range));
    const double error = estimate_mean(node);
    const int index = static_cast<int>(m_nodes.size());
    m_nodes.push_back(node);
    m_product += node.light * static_cast<double>(node.mean);
    if (error <= 0 || (range.width() <= 1 && range.height() <= 1))
      return;
    m_error += error;
    m_queue.push_back({error, index});
    std::push_heap(m_queue.begin(), m_queue.end());
  }

  /// Estimates a rectangle's mean. @return the range of its values times its light
  double estimate_mean(Node& node) const {
    const Values& v = node.values;
    const auto [least, most] = std::minmax_element(std::begin(v.corner), std::end(v.corner));
    float low = std::min(*least, v.centre);
    float high = std::max(*most, v.centre);
    float sum = v.corner[0] + v.corner[1] + v.corner[2] + v.corner[3] + 4.0F * v.centre;
    float count = 8;
    for (const Probe& probe : m_probes)
      if (node.range.contains(probe.x, probe.y)) {
        low = std::min(low, probe.value);
        high = std::max(high, probe.value);
        sum += probe.value;
        count += 1;
      }
    node.mean = sum / count;
    return static_cast<double>(high - low) * node.light;
  }

  /// Products from the leaves upwards; children follow their parents.
  void sum_products() {
    double product = 0;
    for (const Node& node : m_nodes)
      product += node.child < 0 ? node.light * static_cast<double>(node.mean) : 0.0;
    m_floor = product > 0 ? floor_fraction * product / m_nodes[0].light : 1.0;
    for (auto node = m_nodes.rbegin(); node != m_nodes.rend(); ++node) {
      node->product = node->light * (static_cast<double>(node->mean) + m_floor);
      if (node->child < 0)
        continue;
      const Node* const c = &m_nodes[static_cast<std::size_t>(node->child)];
      node->product = c[0].product + c[1].product + c[2].product + c[3].product;
    }
  }

  float density_in(const Node& leaf, const PixelRange& pixel, const Vec2& uv) const {
    const double per_unit = (static_cast<double>(leaf.mean) + m_floor) / m_nodes[0].product;
    const double pixels = static_cast<double>(m_light.all().x1) * m_light.all().y1;
    const auto stretch = static_cast<double>(probe::solid_angle_density(m_light.mapping(), uv));
    return static_cast<float>(per_unit * static_cast<double>(m_light.sum(pixel)) * pixels /
                              std::max(stretch, 1e-30));
  }

  const SummedLight& m_light;
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  std::vector<Probe> m_probes;
  std::vector<Node> m_nodes;
  std::vector<Entry> m_queue; ///< a heap
  double m_error = 0;         ///< of all undivided rectangles
  double m_product = 0;       ///< estimate of ∫ f_r L cos, in units of light
  double m_floor = 0;         ///< least f_r cos of every rectangle
  std::vector<int> m_batch;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_values;
  std::vector<float> m_reflected;
};

class TwoStageSampler : public Sampler {
public:
  TwoStageSampler(std::shared_ptr<const SummedLight> light, int regions)
      : m_light(std::move(light)), m_regions(static_cast<std::size_t>(regions)),
        m_partition(*m_light), m_lobe_points(lobe_probes), m_lobe_samples(lobe_probes) {
    fill_points(Points::Sobol, 0, 0, m_lobe_points);
  }

  /// Probes the mirror direction and samples of the reflectance.
  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
    m_lobe.sample(m_lobe_points, m_lobe_samples);
    m_probes.assign(1, point.reflection.frame.n);
    for (const DirectionSample& s : m_lobe_samples)
      m_probes.push_back(s.direction);
    m_partition.build(point, material, m_probes, m_regions);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec2 uv = m_partition.sample(m_points[i], out[i].pdf);
      out[i].direction = probe::image_to_direction(m_light->mapping(), uv);
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_partition.pdf(probe::direction_to_image(m_light->mapping(), direction));
  }

  std::size_t leaves() const override { return m_partition.regions(); }

private:
  static constexpr std::size_t lobe_probes = 15;

  std::shared_ptr<const SummedLight> m_light;
  std::size_t m_regions;
  LightPartition m_partition;
  Lobe m_lobe;
  std::vector<Vec2> m_lobe_points;
  std::vector<DirectionSample> m_lobe_samples;
  std::vector<Vec3> m_probes;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<SamplerFactory> make_two_stage_factory(const LoadedScene& scene,
                                                       const SamplerOptions& options) {
  const Light& light = scene.light();
  return simple_factory<TwoStageSampler>(
      light.probe() != nullptr ? std::make_shared<const SummedLight>(*light.probe())
                               : std::make_shared<const SummedLight>(tree_as_probe(light)),
      options.regions);
}

} // namespace haarlight::renderer
