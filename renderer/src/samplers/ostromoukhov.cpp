// Representative lights on a Penrose tiling (Ostromoukhov, Donohue and Jodoin 2004, "Fast
// Hierarchical Importance Sampling with Blue Noise Properties") of the equal-area square.
//
// Triangles of four kinds are subdivided into triangles of the same kinds, smaller by the golden
// ratio φ, and sample points. Each point has a number in Fibonacci digits (the F-code), accumulated
// over the subdivisions. For n points per unit area of the tiling, the points numbered below n are
// taken; they are evenly distributed for any n.

#include "samplers/representative_lights.h"
#include "samplers/sampler_factories.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <array>
#include <queue>

namespace haarlight::renderer {
namespace {

using Point = Eigen::Vector2d;

/// The unit vector `turns` twentieths of a turn from north, anticlockwise.
Point turned(int turns) {
  const double root5 = std::sqrt(5.0);
  const Point step((root5 - 1) / 4,
                   std::sqrt(10 + 2 * root5) / 4); // sine and cosine of a turn / 20
  Point result(0, 1);
  for (int i = 0; i < turns % 20; ++i)
    result = Point(result.x() * step.y() - result.y() * step.x(),
                   result.x() * step.x() + result.y() * step.y());
  return result;
}

/// The paper's tiles: c and d are slim triangles, e and f broad ones. Its a and b are points.
enum class Tile : std::uint8_t { Slim, SlimMirrored, Broad, BroadMirrored, Sample };

/// Leading digits of an F-code.
enum class Digits : std::uint8_t { Zero, Low, High };

/// A part of a tile: its position, direction and digits.
struct Part {
  Tile tile;
  int anchor; ///< −1 = the subdivided tile, else an earlier part of it
  int corner; ///< of the anchor
  int turn;   ///< relative to the subdivided tile, in twentieths
  Digits digits;
};

constexpr int whole = -1;

constexpr std::array slim_parts = {Part{Tile::BroadMirrored, whole, 2, 14, Digits::Zero},
                                   Part{Tile::Slim, whole, 1, 6, Digits::High},
                                   Part{Tile::Sample, 0, 2, 1, Digits::High}};
constexpr std::array slim_mirrored_parts = {Part{Tile::Broad, whole, 1, 6, Digits::Zero},
                                            Part{Tile::SlimMirrored, 0, 2, 14, Digits::High}};
constexpr std::array broad_parts = {Part{Tile::Slim, whole, 2, 12, Digits::High},
                                    Part{Tile::Broad, whole, 1, 8, Digits::Low},
                                    Part{Tile::BroadMirrored, whole, 0, 0, Digits::Zero},
                                    Part{Tile::Sample, 0, 1, 7, Digits::High}};
constexpr std::array broad_mirrored_parts = {
    Part{Tile::BroadMirrored, whole, 2, 12, Digits::Low}, Part{Tile::Broad, 0, 2, 0, Digits::Zero},
    Part{Tile::SlimMirrored, 1, 2, 8, Digits::High}, Part{Tile::Sample, 0, 2, 15, Digits::Low}};

constexpr std::array<std::span<const Part>, 4> parts_of = {slim_parts, slim_mirrored_parts,
                                                           broad_parts, broad_mirrored_parts};

constexpr double golden = 1.6180339887498949;

/// A tile with its position.
struct Placed {
  Tile tile = Tile::BroadMirrored;
  int direction = 15; ///< of its first side, in twentieths of a turn; 15 = +x
  int level = 0;
  double number = 0; ///< value of the digits so far
  double scale = 1;
  std::array<Point, 3> corners;

  void set_corners(const Point& first) {
    const bool slim = tile == Tile::Slim || tile == Tile::SlimMirrored;
    corners[0] = first;
    corners[1] = first + turned(direction) * (slim ? scale : golden * golden * scale);
    corners[2] = first + turned(direction + (slim ? 4 : 2)) * (golden * scale);
  }
};

/// The k-th Fibonacci number; F₁ = F₂ = 1.
double fibonacci(int k) {
  double low = 0;
  double high = 1;
  for (int i = 1; i < k; ++i) {
    const double sum = low + high;
    low = high;
    high = sum;
  }
  return high;
}

double value_of(Digits digits, int level) {
  return digits == Digits::Zero ? 0 : fibonacci(2 * level + (digits == Digits::High ? 1 : 0));
}

/// A pyramid of the maximum luminance of a map's pixels.
class Maxima {
public:
  explicit Maxima(const LightPixels& pixels) : m_levels{pixels.luminance} {
    for (int side = pixels.size / 2; side >= 1; side /= 2)
      m_levels.push_back(halved(m_levels.back(), static_cast<std::size_t>(side)));
    m_size = pixels.size;
  }

  /// At a point of the square.
  float at(const Point& p) const { return m_levels[0][index(0, cell(0, p.x()), cell(0, p.y()))]; }

  /// An upper bound for a rectangle, clipped to the square; 0 if it lies outside.
  float within(const Point& low, const Point& high) const {
    if (low.x() >= 1 || low.y() >= 1 || high.x() < 0 || high.y() < 0)
      return 0;
    const double extent = (high - low).maxCoeff() * m_size;
    int level = 0;
    while (level + 1 < static_cast<int>(m_levels.size()) && (1 << level) < extent)
      ++level;
    float result = 0;
    for (int y = cell(level, low.y()); y <= cell(level, high.y()); ++y)
      for (int x = cell(level, low.x()); x <= cell(level, high.x()); ++x)
        result = std::max(result, m_levels[static_cast<std::size_t>(level)][index(level, x, y)]);
    return result;
  }

private:
  static std::vector<float> halved(const std::vector<float>& finer, std::size_t side) {
    std::vector<float> result(side * side);
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x) {
        const float* p = finer.data() + 4 * y * side + 2 * x;
        result[y * side + x] = std::max({p[0], p[1], p[2 * side], p[2 * side + 1]});
      }
    return result;
  }

  int cell(int level, double coordinate) const {
    const int side = m_size >> level;
    return static_cast<int>(std::clamp(coordinate * side, 0.0, side - 1.0));
  }

  std::size_t index(int level, int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(m_size >> level) +
           static_cast<std::size_t>(x);
  }

  int m_size = 0;
  std::vector<std::vector<float>> m_levels;
};

/// Enumerates the points in the order in which an increasing density includes them: a point once
/// its luminance times the density reaches its number, a triangle once that reaches the least
/// number of its points.
class Tiling {
public:
  explicit Tiling(const LightPixels& pixels) : m_maxima(pixels) {
    Placed root;
    root.scale = 2;
    // The tile contains the square.
    root.set_corners(Point(0.5 - golden * golden, -0.25));
    push(root);
  }

  /// The next point; none if the light is black.
  std::optional<Point> next() {
    while (!m_queue.empty()) {
      const Placed tile = m_queue.top().tile;
      m_queue.pop();
      if (tile.tile == Tile::Sample)
        return tile.corners[0];
      split(tile);
    }
    return std::nullopt;
  }

private:
  struct Entry {
    double demand = 0;
    std::uint64_t turn = 0; ///< breaks ties
    Placed tile;

    bool operator<(const Entry& other) const {
      return demand != other.demand ? demand > other.demand : turn > other.turn;
    }
  };

  void split(const Placed& tile) {
    std::array<Placed, 4> parts;
    const std::span<const Part> rules = parts_of[static_cast<std::size_t>(tile.tile)];
    for (std::size_t i = 0; i < rules.size(); ++i) {
      const Part& rule = rules[i];
      const Placed& anchor =
          rule.anchor == whole ? tile : parts[static_cast<std::size_t>(rule.anchor)];
      Placed& part = parts[i];
      part.tile = rule.tile;
      part.direction = (tile.direction + rule.turn) % 20;
      part.level = tile.level + 1;
      part.number = tile.number + value_of(rule.digits, part.level);
      part.scale = tile.scale / golden;
      part.set_corners(anchor.corners[static_cast<std::size_t>(rule.corner)]);
      push(part);
    }
  }

  void push(const Placed& tile) {
    const double luminance = static_cast<double>(luminance_of(tile));
    if (!(luminance > 0))
      return;
    // Points of the next level have at least one digit more than the triangle.
    const double number =
        tile.tile == Tile::Sample ? tile.number : tile.number + fibonacci(2 * (tile.level + 1));
    m_queue.push({number / luminance, m_turn++, tile});
  }

  /// Of a point, or the maximum in a triangle.
  float luminance_of(const Placed& tile) const {
    const auto& [a, b, c] = tile.corners;
    if (tile.tile == Tile::Sample)
      return a.minCoeff() >= 0 && a.maxCoeff() < 1 ? m_maxima.at(a) : 0;
    return m_maxima.within(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
  }

  Maxima m_maxima;
  std::priority_queue<Entry> m_queue;
  std::uint64_t m_turn = 0;
};

std::size_t pixel_at(const LightPixels& pixels, const Point& p) {
  const auto x = static_cast<std::size_t>(p.x() * pixels.size);
  const auto y = static_cast<std::size_t>(p.y() * pixels.size);
  return y * static_cast<std::size_t>(pixels.size) + x;
}

/// `count` points, each with the reciprocal of its density as solid angle.
std::vector<RepresentativeLight> lights_of_tiling(const LightPixels& pixels, std::size_t count) {
  double energy = 0;
  for (const float y : pixels.luminance)
    energy += static_cast<double>(y) * static_cast<double>(pixels.solid_angle);
  const double share = energy / static_cast<double>(count);
  Tiling tiling(pixels);
  std::vector<RepresentativeLight> lights;
  while (lights.size() < count) {
    const std::optional<Point> p = tiling.next();
    if (!p)
      break;
    const std::size_t i = pixel_at(pixels, *p);
    lights.push_back({wavelet::square_to_sphere(Vec2(p->cast<float>())), pixels.radiance[i],
                      static_cast<float>(share / static_cast<double>(pixels.luminance[i]))});
  }
  return lights;
}

} // namespace

std::unique_ptr<SamplerFactory> make_ostromoukhov_factory(const LoadedScene& scene,
                                                          const SamplerOptions& options) {
  return representative_light_factory(scene.light(), lights_of_tiling, options);
}

} // namespace haarlight::renderer
