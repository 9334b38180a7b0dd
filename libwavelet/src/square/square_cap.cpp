#include <wavelet/square/square_cap.h>

#include <algorithm>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Squares look widest from their centres towards a corner; this much is added for what edges may
/// bulge and for rounding.
constexpr float radius_pad = 1.01F;

/// a u² + b u + c.
struct Quadratic {
  float a, b, c;

  float at(float u) const { return (a * u + b) * u + c; }
};

/// Through the values at −1, 0 and 1.
Quadratic quadratic_through(float before, float middle, float after) {
  return {0.5F * (before + after) - middle, 0.5F * (after - before), middle};
}

/// Numbers in (−1, 1), ascending, with −1 before and 1 after them.
class Breaks {
public:
  /// Adds the roots of a quadratic that lie within.
  void add_roots(const Quadratic& f) {
    const float discriminant = f.b * f.b - 4 * f.a * f.c;
    if (discriminant < 0)
      return;
    const float half = -0.5F * (f.b + std::copysign(std::sqrt(discriminant), f.b));
    if (f.a != 0)
      add(half / f.a);
    if (half != 0)
      add(f.c / half);
  }

  /// Calls visit(begin, end) for what lies between neighbours.
  template <class Visit>
  void for_gaps(const Visit& visit) {
    float begin = -1;
    for (std::size_t i = 0; i < m_count; ++i) {
      visit(begin, m_values[i]);
      begin = m_values[i];
    }
    visit(begin, 1.0F);
  }

private:
  void add(float value) {
    if (!(value > -1 && value < 1))
      return;
    std::size_t place = m_count++;
    for (; place > 0 && m_values[place - 1] > value; --place)
      m_values[place] = m_values[place - 1];
    m_values[place] = value;
  }

  std::array<float, 4> m_values = {};
  std::size_t m_count = 0;
};

/// The length of what lies in [−1, 1] where the quadratic is positive.
float positive_length(const Quadratic& f) {
  Breaks breaks;
  breaks.add_roots(f);
  float sum = 0;
  breaks.for_gaps([&](float begin, float end) {
    if (f.at(0.5F * (begin + end)) > 0)
      sum += end - begin;
  });
  return sum;
}

SquareValues transposed(const SquareValues& v) {
  return {v[0], v[3], v[6], v[1], v[4], v[7], v[2], v[5], v[8]};
}

} // namespace

SquareCap square_cap(const Square& square) {
  SquareCap cap;
  const float side = power_of_two(-square.level);
  cap.centre = square_to_sphere(Vec2((static_cast<float>(square.column) + 0.5F) * side,
                                     (static_cast<float>(square.row) + 0.5F) * side));
  if (square.level == 0)
    return cap;
  const Float4 u = (static_cast<float>(square.column) + Float4{0, 1, 0, 1}) * side;
  const Float4 v = (static_cast<float>(square.row) + Float4{0, 0, 1, 1}) * side;
  Float4 x;
  Float4 y;
  Float4 z;
  square_to_sphere(u, v, x, y, z);
  x -= cap.centre.x();
  y -= cap.centre.y();
  z -= cap.centre.z();
  const Float4 chords = x * x + y * y + z * z; // without cancellation for small squares
  const float farthest = std::max(std::max(chords[0], chords[1]), std::max(chords[2], chords[3]));
  const float chord = std::min(square.level == 1 ? 2.0F : radius_pad * radius_pad * farthest, 2.0F);
  cap.cosine = 1 - 0.5F * chord;
  cap.sine = std::sqrt(chord * (1 - 0.25F * chord));
  return cap;
}

SquareDirections square_directions(const Square& square) {
  const float side = power_of_two(-square.level);
  const float u = static_cast<float>(square.column) * side;
  const float v = static_cast<float>(square.row) * side;
  const Float4 columns[3] = {{0, 0.5F, 1, 0}, {0.5F, 1, 0, 0.5F}, {1, 1, 1, 1}};
  const Float4 rows[3] = {{0, 0, 0, 0.5F}, {0.5F, 0.5F, 1, 1}, {1, 1, 1, 1}};
  SquareDirections result;
  for (std::size_t i = 0; i < 3; ++i)
    square_to_sphere(u + side * columns[i], v + side * rows[i], result.x[i], result.y[i],
                     result.z[i]);
  return result;
}

bool nearly_linear(const SquareValues& v) {
  constexpr float bend_limit = 0.1F; ///< of the change from centre to edge
  const float change = std::max(std::abs(v[5] - v[3]), std::abs(v[7] - v[1]));
  const float bend = std::abs(v[3] + v[5] - 2 * v[4]) + std::abs(v[1] + v[7] - 2 * v[4]) +
                     0.25F * std::abs(v[0] + v[8] - v[2] - v[6]);
  if (bend <= bend_limit * change)
    return true;
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  return *low > bend || *high < -bend; // one sign all over, whatever its shape
}

float positive_fraction(const SquareValues& given) {
  const bool along_rows = std::abs(given[5] - given[3]) >= std::abs(given[7] - given[1]);
  const SquareValues v = along_rows ? given : transposed(given);
  std::array<Quadratic, 3> columns;
  for (std::size_t i = 0; i < 3; ++i)
    columns[i] = quadratic_through(v[i], v[i + 3], v[i + 6]);
  Breaks breaks;
  breaks.add_roots(columns[0]);
  breaks.add_roots(columns[2]);
  float sum = 0;
  breaks.for_gaps([&](float begin, float end) {
    constexpr float nodes[3] = {-0.77459667F, 0, 0.77459667F};
    constexpr float weights[3] = {5.0F / 18, 8.0F / 18, 5.0F / 18};
    for (std::size_t i = 0; i < 3; ++i) {
      const float at = 0.5F * (begin + end) + 0.5F * (end - begin) * nodes[i];
      sum += (end - begin) * weights[i] *
             positive_length(
                 quadratic_through(columns[0].at(at), columns[1].at(at), columns[2].at(at)));
    }
  });
  return std::clamp(0.25F * sum, 0.0F, 1.0F);
}

} // namespace haarlight::wavelet
