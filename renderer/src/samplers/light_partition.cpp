#include "samplers/light_partition.h"

#include <algorithm>

namespace haarlight::renderer {
namespace {

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

} // namespace

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

} // namespace haarlight::renderer
