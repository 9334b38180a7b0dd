// A line through the torus. Counted from the line's point next to the torus's centre, its quartic
// has no cubic term; the roots are bracketed between the quartic's own extrema, so that none is
// lost or invented, and without the trigonometry of closed forms.

#include "shapes/shape_canonical.h"

#include <algorithm>
#include <cmath>

namespace haarlight::renderer::detail {
namespace {

constexpr double wider = 1.0001;

/// t⁴ + p t² + q t + r.
struct DepressedQuartic {
  double p;
  double q;
  double r;

  double value(double t) const { return ((t * t + p) * t + q) * t + r; }
  double slope(double t) const { return (4 * t * t + 2 * p) * t + q; }
  double curvature(double t) const { return 12 * t * t + 2 * p; }
};

/// The root of a function that is monotone on [low, high] and changes sign there: Newton's steps,
/// halving the bracket instead where they leave it.
template <class Value, class Slope>
double bracketed_root(double low, double high, double tolerance, Value value, Slope slope) {
  const bool rises = value(high) > 0;
  double t = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const double f = value(t);
    ((f > 0) == rises ? high : low) = t;
    double next = t - f / slope(t);
    if (!(next >= low && next <= high))
      next = 0.5 * (low + high);
    const double step = std::abs(next - t);
    t = next;
    if (step <= tolerance)
      break;
  }
  return t;
}

bool changes_sign(double a, double b) { return (a > 0) != (b > 0); }

/// Walks along the pieces on which the quartic is monotone, looking for a change of sign.
class RootSearch {
public:
  RootSearch(const DepressedQuartic& quartic, double begin)
      : m_quartic(quartic), m_from(begin), m_value(quartic.value(begin)) {}

  /// Looks from where the search stands to `to`; true if root() was found there.
  bool reaches(double to) {
    const double value = m_quartic.value(to);
    if (!changes_sign(m_value, value)) {
      m_from = to;
      m_value = value;
      return false;
    }
    m_root = bracketed_root(
        m_from, to, 4e-16, [&](double t) { return m_quartic.value(t); },
        [&](double t) { return m_quartic.slope(t); });
    return true;
  }

  /// The same, stopping at an extremum between `low` and `high`, if the slope's sign tells of one.
  bool passes_extremum(double low, double high) {
    if (!(low < high) || !changes_sign(m_quartic.slope(low), m_quartic.slope(high)))
      return false;
    return reaches(bracketed_root(
        low, high, 1e-10, [&](double t) { return m_quartic.slope(t); },
        [&](double t) { return m_quartic.curvature(t); }));
  }

  double root() const { return m_root; }

private:
  const DepressedQuartic& m_quartic;
  double m_from;
  double m_value;
  double m_root = no_hit;
};

/// The smallest root in (low, high), or no_hit.
double first_root(const DepressedQuartic& quartic, double low, double high) {
  RootSearch search(quartic, low);
  const double turn = quartic.p < 0 ? std::sqrt(quartic.p / -6) : 0; // where the slope has extrema
  const double left = std::clamp(-turn, low, high);
  const double right = std::clamp(turn, low, high);
  const bool found = search.passes_extremum(low, left) || search.passes_extremum(left, right) ||
                     search.passes_extremum(right, high) || search.reaches(high);
  return found ? search.root() : no_hit;
}

} // namespace

double torus_distance(double tube, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction) {
  const double length = direction.norm();
  const Eigen::Vector3d d = direction / length;
  const double start = origin.dot(d);
  const Eigen::Vector3d o = origin - start * d;
  const double away = o.squaredNorm();
  // A little wider than the torus, so that no search starts on its very surface.
  const double reach = wider * (1 + tube) * (1 + tube) - away;
  if (reach <= 0)
    return no_hit;
  const double half = std::sqrt(reach);
  const Interval span = intersect(slab(o.z(), d.z(), wider * tube), {std::max(start, -half), half});
  if (!(span.enter < span.exit))
    return no_hit;
  // (|p|² + 1 − tube²)² = 4 (x² + y²), with |p|² = t² + away.
  const double k = away + 1 - tube * tube;
  const DepressedQuartic quartic{2 * k - 4 * (d.x() * d.x() + d.y() * d.y()),
                                 -8 * (o.x() * d.x() + o.y() * d.y()),
                                 k * k - 4 * (o.x() * o.x() + o.y() * o.y())};
  return (first_root(quartic, span.enter, span.exit) - start) / length;
}

} // namespace haarlight::renderer::detail
