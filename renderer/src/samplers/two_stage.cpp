// Two-stage importance sampling (Cline, Egbert, Talbot and Cardon 2006): the probe's picture is
// divided by the reflectance at each point, a region is chosen by the product of both, and a place
// in it by the light's summed-area table.

#include "samplers/basic_samplers.h"
#include "samplers/sampler_factories.h"

#include <renderer/material/material.h>

#include <probe/probe.h>
#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

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
};

/// A pixel's light is its luminance times its solid angle, as a whole number of units, of which
/// every pixel that shines has one at least: sums are exact, so that what is drawn has exactly the
/// density that is said.
class LightSums {
public:
  /// Keeps nothing of the probe but its shape.
  explicit LightSums(const probe::Probe& probe);

  int width() const { return m_width; }
  int height() const { return m_height; }

  /// Light of a range, in units.
  std::uint64_t sum(const PixelRange& r) const {
    return at(r.x1, r.y1) - at(r.x0, r.y1) - at(r.x1, r.y0) + at(r.x0, r.y0);
  }

  /// A point of the image, in [0, 1]², and the light of its pixel.
  struct Place {
    Vec2 uv;
    std::uint64_t light = 0;
  };

  /// Inverts the cdf of the columns of a range that shines with u, that of the column with v; the
  /// point is uniform in its pixel.
  /// @param u,v in [0, 1)
  Place draw(const PixelRange& range, double u, double v) const;

private:
  std::uint64_t at(int x, int y) const {
    return m_sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(m_width + 1) +
                  static_cast<std::size_t>(x)];
  }

  int m_width;
  int m_height;
  std::vector<std::uint64_t> m_sums; ///< of all pixels above and to the left
};

constexpr double all_units = 0x1p52; ///< so many or a little more: exact as double too

/// Where a place in the light of a range falls: the first step whose sum surpasses it, and how far
/// into that step it is.
struct Step {
  int index = 0;
  double fraction = 0;
};

/// @param sum_up_to light of the steps before a given one; grows from 0 at `begin`
template <class Sum>
Step find_step(int begin, int end, double u, Sum sum_up_to) {
  const double place = u * static_cast<double>(sum_up_to(end));
  int low = begin;
  int high = end;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (static_cast<double>(sum_up_to(middle)) <= place ? low : high) = middle;
  }
  const auto before = static_cast<double>(sum_up_to(low));
  const auto width = static_cast<double>(sum_up_to(high)) - before;
  return {low, width > 0 ? std::min((place - before) / width, 0x1.fffffep-1) : 0.5};
}

LightSums::LightSums(const probe::Probe& probe)
    : m_width(probe.width()), m_height(probe.height()),
      m_sums(static_cast<std::size_t>(m_width + 1) * static_cast<std::size_t>(m_height + 1)) {
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

LightSums::Place LightSums::draw(const PixelRange& r, double u, double v) const {
  const Step column = find_step(r.x0, r.x1, u, [&](int x) { return sum({r.x0, r.y0, x, r.y1}); });
  const int x = column.index;
  const Step row = find_step(r.y0, r.y1, v, [&](int y) { return sum({x, r.y0, x + 1, y}); });
  const int y = row.index;
  return {Vec2(static_cast<float>((x + column.fraction) / m_width),
               static_cast<float>((y + row.fraction) / m_height)),
          sum({x, y, x + 1, y + 1})};
}

/// A probe as partitions see it; shared by threads.
struct LightPicture {
  probe::Mapping mapping;
  LightSums sums;

  explicit LightPicture(const probe::Probe& probe) : mapping(probe.mapping()), sums(probe) {}

  /// The pixel an image point lies in.
  std::pair<int, int> pixel(const Vec2& uv) const {
    return {
        std::min(static_cast<int>(uv.x() * static_cast<float>(sums.width())), sums.width() - 1),
        std::min(static_cast<int>(uv.y() * static_cast<float>(sums.height())), sums.height() - 1)};
  }
};

/// A quadtree of rectangles. Each guesses the mean of f_r cos (luminance) over itself from its
/// corners, its centre and the marks inside; the one whose values differ most, times
/// its light, is divided next. All densities are exactly those of the descent.
class LightPartition {
public:
  explicit LightPartition(const LightPicture& picture) : m_picture(picture) {}

  /// @param marks directions where the reflectance may rise where no corner sees it
  /// @param regions undivided rectangles at most, 4 or more
  void build(const ShadingPoint& point, const Material& material, std::span<const Vec3> marks,
             std::size_t regions);

  /// Warps a point of the unit square through the tree, then through the light of the region.
  /// @param density receives the place's density, sr⁻¹; 0 if it is no direction
  Vec2 sample(const Vec2& u, float& density) const;

  /// Density of sample() at an image point, sr⁻¹.
  float pdf(const Vec2& uv) const;

  std::size_t regions() const { return 1 + (m_nodes.size() - 1) / 4 * 3; }

private:
  static constexpr std::size_t batch = 8; ///< rectangles divided at a time
  static constexpr std::size_t points_per_split = 8;

  struct Values {
    float corner[4] = {}; ///< (x0, y0), (x1, y0), (x0, y1), (x1, y1)
    float centre = 0;
  };
  struct Node {
    PixelRange range;
    Values values;
    double light = 0;
    double product = 0;
    float mean = 0; ///< guess of f_r cos
    int child = -1; ///< first of four, in the order of the corners; −1 undivided
  };
  struct Entry {
    double error;
    int node;
    bool operator<(const Entry& other) const { return error < other.error; }
  };
  struct Mark {
    int x = 0; ///< pixel
    int y = 0;
    float value = 0;
  };

  void start();
  void evaluate_marks(std::span<const Vec3> marks);
  bool is_fine() const;
  void split_batch();
  void split(int node, std::span<const float> fresh);
  void request_split(const Node& node);
  void request(float x, float y);
  void request_centre(const PixelRange& range);
  void evaluate();
  int add(const PixelRange& range, const Values& values);
  double judge(Node& node) const;
  void sum_products();
  float density(const Node& leaf, std::uint64_t light, const Vec2& uv) const;

  const LightPicture& m_picture;
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  std::vector<Mark> m_marks;
  std::vector<Node> m_nodes;
  std::vector<Entry> m_queue; ///< a heap
  double m_error = 0;         ///< of all undivided rectangles
  double m_product = 0;       ///< guess of ∫ f_r L cos, in units of light
  double m_floor = 0;         ///< f_r cos that every rectangle has at least
  std::vector<int> m_batch;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_values;
  std::vector<float> m_reflected;
};

constexpr double tolerable_error = 0.25; ///< of the values' spread, relative to the product
constexpr double floor_share = 0.05;     ///< of samples, about, that follow the light alone

/// Where a range is divided: between pixels.
int middle(int from, int to) { return (from + to) / 2; }

/// Where its centre is looked up: where it would be divided, or in the middle of the one pixel.
float centre(int from, int to) {
  return to - from > 1 ? static_cast<float>(middle(from, to)) : static_cast<float>(from) + 0.5F;
}

bool is_pixel(const PixelRange& r) { return r.width() <= 1 && r.height() <= 1; }

bool contains(const PixelRange& r, int x, int y) {
  return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
}

/// One of the quarters, in the order of the corners.
PixelRange quarter(const PixelRange& r, int i) {
  const int x = middle(r.x0, r.x1);
  const int y = middle(r.y0, r.y1);
  return {i % 2 == 0 ? r.x0 : x, i < 2 ? r.y0 : y, i % 2 == 0 ? x : r.x1, i < 2 ? y : r.y1};
}

/// Chooses the second of two parts if u lies beyond the first, and stretches u over the chosen.
bool choose_second(double first, double second, double& u) {
  const double place = u * (first + second);
  const bool is_second = place >= first;
  u = is_second ? (place - first) / second : place / first;
  u = std::min(u, 0x1.fffffep-1);
  return is_second;
}

void LightPartition::build(const ShadingPoint& point, const Material& material,
                           std::span<const Vec3> marks, std::size_t regions) {
  m_point = &point;
  m_material = &material;
  evaluate_marks(marks);
  start();
  while (!m_queue.empty() && this->regions() + 3 * batch <= regions && !is_fine())
    split_batch();
  sum_products();
}

void LightPartition::evaluate_marks(std::span<const Vec3> marks) {
  m_marks.resize(marks.size());
  m_directions.assign(marks.begin(), marks.end());
  evaluate();
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const auto [x, y] = m_picture.pixel(probe::direction_to_image(m_picture.mapping, marks[i]));
    m_marks[i] = {x, y, m_reflected[i]};
  }
}

/// One rectangle, the whole picture.
void LightPartition::start() {
  m_nodes.clear();
  m_queue.clear();
  m_error = 0;
  m_product = 0;
  const PixelRange all = {0, 0, m_picture.sums.width(), m_picture.sums.height()};
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

void LightPartition::request(float x, float y) {
  const Vec2 uv(x / static_cast<float>(m_picture.sums.width()),
                y / static_cast<float>(m_picture.sums.height()));
  m_directions.push_back(probe::image_to_direction(m_picture.mapping, uv));
}

void LightPartition::request_centre(const PixelRange& r) {
  request(centre(r.x0, r.x1), centre(r.y0, r.y1));
}

/// Turns requested directions to f_r cos.
void LightPartition::evaluate() {
  m_values.resize(m_directions.size());
  m_reflected.resize(m_directions.size());
  m_material->evaluate(*m_point, m_directions, m_values);
  for (std::size_t i = 0; i < m_values.size(); ++i)
    m_reflected[i] = luminance(m_values[i]);
  m_directions.clear();
}

bool LightPartition::is_fine() const { return m_error <= tolerable_error * m_product; }

void LightPartition::split_batch() {
  m_batch.clear();
  while (m_batch.size() < batch && !m_queue.empty()) {
    std::pop_heap(m_queue.begin(), m_queue.end());
    const Entry entry = m_queue.back();
    m_queue.pop_back();
    const Node& node = m_nodes[static_cast<std::size_t>(entry.node)];
    m_error -= entry.error;
    m_product -= node.light * static_cast<double>(node.mean);
    m_batch.push_back(entry.node);
    request_split(node);
  }
  evaluate();
  for (std::size_t i = 0; i < m_batch.size(); ++i)
    split(m_batch[i], std::span(m_reflected).subspan(i * points_per_split, points_per_split));
}

/// The points that a rectangle's quarters have in addition to its own: the middles of its sides and
/// their centres.
void LightPartition::request_split(const Node& node) {
  const PixelRange& r = node.range;
  const auto x = static_cast<float>(middle(r.x0, r.x1));
  const auto y = static_cast<float>(middle(r.y0, r.y1));
  request(x, static_cast<float>(r.y0));
  request(static_cast<float>(r.x0), y);
  request(static_cast<float>(r.x1), y);
  request(x, static_cast<float>(r.y1));
  for (int i = 0; i < 4; ++i)
    request_centre(quarter(r, i));
}

/// @param fresh top, left, right, bottom, and the quarters' centres
void LightPartition::split(int index, std::span<const float> fresh) {
  const Node node = m_nodes[static_cast<std::size_t>(index)];
  const float* const c = node.values.corner;
  const float m = node.values.centre;
  const float corners[4][4] = {{c[0], fresh[0], fresh[1], m},
                               {fresh[0], c[1], m, fresh[2]},
                               {fresh[1], m, c[2], fresh[3]},
                               {m, fresh[2], fresh[3], c[3]}};
  m_nodes[static_cast<std::size_t>(index)].child = static_cast<int>(m_nodes.size());
  for (int i = 0; i < 4; ++i) {
    Values values;
    std::copy_n(corners[i], 4, values.corner);
    values.centre = fresh[4 + static_cast<std::size_t>(i)];
    add(quarter(node.range, i), values);
  }
}

int LightPartition::add(const PixelRange& range, const Values& values) {
  Node node;
  node.range = range;
  node.values = values;
  node.light = static_cast<double>(m_picture.sums.sum(range));
  const double error = judge(node);
  const int index = static_cast<int>(m_nodes.size());
  m_nodes.push_back(node);
  m_product += node.light * static_cast<double>(node.mean);
  if (error <= 0 || is_pixel(range))
    return index;
  m_error += error;
  m_queue.push_back({error, index});
  std::push_heap(m_queue.begin(), m_queue.end());
  return index;
}

/// Guesses a rectangle's mean. @return how far off it may be
double LightPartition::judge(Node& node) const {
  const Values& v = node.values;
  const auto [least, most] = std::minmax_element(std::begin(v.corner), std::end(v.corner));
  float low = std::min(*least, v.centre);
  float high = std::max(*most, v.centre);
  float sum = v.corner[0] + v.corner[1] + v.corner[2] + v.corner[3] + 4.0F * v.centre;
  float count = 8;
  for (const Mark& mark : m_marks)
    if (contains(node.range, mark.x, mark.y)) {
      low = std::min(low, mark.value);
      high = std::max(high, mark.value);
      sum += mark.value;
      count += 1;
    }
  node.mean = sum / count;
  return static_cast<double>(high - low) * node.light;
}

/// Products from the leaves upwards; children stand behind their parents.
void LightPartition::sum_products() {
  double product = 0;
  for (const Node& node : m_nodes)
    product += node.child < 0 ? node.light * static_cast<double>(node.mean) : 0.0;
  m_floor = product > 0 ? floor_share * product / m_nodes[0].light : 1.0;
  for (auto node = m_nodes.rbegin(); node != m_nodes.rend(); ++node) {
    node->product = node->light * (static_cast<double>(node->mean) + m_floor);
    if (node->child < 0)
      continue;
    const Node* const c = &m_nodes[static_cast<std::size_t>(node->child)];
    node->product = c[0].product + c[1].product + c[2].product + c[3].product;
  }
}

float LightPartition::density(const Node& leaf, std::uint64_t light, const Vec2& uv) const {
  const double per_unit = (static_cast<double>(leaf.mean) + m_floor) / m_nodes[0].product;
  const double pixels = static_cast<double>(m_picture.sums.width()) * m_picture.sums.height();
  const auto stretch = static_cast<double>(probe::solid_angle_density(m_picture.mapping, uv));
  return static_cast<float>(per_unit * static_cast<double>(light) * pixels /
                            std::max(stretch, 1e-30));
}

Vec2 LightPartition::sample(const Vec2& point, float& pdf) const {
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
  const LightSums::Place place = m_picture.sums.draw(node->range, u, v);
  pdf = probe::in_map(m_picture.mapping, place.uv) ? density(*node, place.light, place.uv) : 0.0F;
  return place.uv;
}

float LightPartition::pdf(const Vec2& uv) const {
  const auto [x, y] = m_picture.pixel(uv);
  const Node* node = m_nodes.data();
  while (node->child >= 0) {
    const PixelRange& r = node->range;
    const std::size_t right = x >= middle(r.x0, r.x1) ? 1 : 0;
    const std::size_t below = y >= middle(r.y0, r.y1) ? 2 : 0;
    node = &m_nodes[static_cast<std::size_t>(node->child) + right + below];
  }
  return density(*node, m_picture.sums.sum({x, y, x + 1, y + 1}), uv);
}

std::shared_ptr<const LightPicture> light_picture(const Light& light) {
  if (light.probe() != nullptr)
    return std::make_shared<const LightPicture>(*light.probe());
  return std::make_shared<const LightPicture>(tree_as_probe(light));
}

class TwoStageSampler : public Sampler {
public:
  TwoStageSampler(std::shared_ptr<const LightPicture> picture, int regions)
      : m_picture(std::move(picture)), m_regions(static_cast<std::size_t>(regions)),
        m_partition(*m_picture), m_mark_points(marks_of_lobe), m_mark_samples(marks_of_lobe) {
    fill_points(Points::Sobol, 0, 0, m_mark_points);
  }

  /// The partition's marks are the mirror direction and what the reflectance's own tree draws.
  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
    m_lobe.sample(m_mark_points, m_mark_samples);
    m_marks.assign(1, point.reflection.frame.n);
    for (const DirectionSample& s : m_mark_samples)
      m_marks.push_back(s.direction);
    m_partition.build(point, material, m_marks, m_regions);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec2 uv = m_partition.sample(m_points[i], out[i].pdf);
      out[i].direction = probe::image_to_direction(m_picture->mapping, uv);
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_partition.pdf(probe::direction_to_image(m_picture->mapping, direction));
  }

  std::size_t leaves() const override { return m_partition.regions(); }

private:
  static constexpr std::size_t marks_of_lobe = 15;

  std::shared_ptr<const LightPicture> m_picture;
  std::size_t m_regions;
  LightPartition m_partition;
  Lobe m_lobe;
  std::vector<Vec2> m_mark_points;
  std::vector<DirectionSample> m_mark_samples;
  std::vector<Vec3> m_marks;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<SamplerFactory> make_two_stage_factory(const LoadedScene& scene,
                                                       const SamplerOptions& options) {
  return simple_factory<TwoStageSampler>(light_picture(scene.light()), options.regions);
}

} // namespace haarlight::renderer
