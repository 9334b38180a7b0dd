#pragma once
// An independent account of the shapes: exact signed distances in double, and rays followed by
// stepping as far as the distance allows. Slow, and shares nothing with the library.

#include <renderer/shapes/shape.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace reference {

using Eigen::Vector2d;
using Eigen::Vector3d;

inline double distance(const haarlight::renderer::Sphere& s, const Vector3d& p) {
  return (p - s.center.cast<double>()).norm() - s.radius;
}

inline double distance(const haarlight::renderer::Plane& s, const Vector3d& p) {
  return s.normal.cast<double>().normalized().dot(p - s.point.cast<double>());
}

/// Height along the axis and distance from it.
inline Vector2d profile(const haarlight::Vec3& origin, const haarlight::Vec3& axis,
                        const Vector3d& p) {
  const Vector3d n = axis.cast<double>().normalized();
  const Vector3d v = p - origin.cast<double>();
  return {n.dot(v), (v - n.dot(v) * n).norm()};
}

inline double distance(const haarlight::renderer::Disk& s, const Vector3d& p) {
  const Vector2d q = profile(s.center, s.normal, p);
  return std::hypot(q.x(), std::max(q.y() - s.radius, 0.0));
}

inline double distance(const haarlight::renderer::Box& s, const Vector3d& p) {
  const Vector3d middle = 0.5 * (s.low.cast<double>() + s.high.cast<double>());
  const Vector3d q = (p - middle).cwiseAbs() - 0.5 * (s.high.cast<double>() - s.low.cast<double>());
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

inline double distance(const haarlight::renderer::Cylinder& s, const Vector3d& p) {
  const Vector3d axis = s.top.cast<double>() - s.base.cast<double>();
  const Vector2d q = profile(s.base, s.top - s.base, p);
  const Vector2d beyond(std::abs(q.x() - 0.5 * axis.norm()) - 0.5 * axis.norm(), q.y() - s.radius);
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

inline double segment_distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

inline double distance(const haarlight::renderer::Cone& s, const Vector3d& p) {
  const double height = (s.apex.cast<double>() - s.base.cast<double>()).norm();
  const Vector2d q = profile(s.base, s.apex - s.base, p);
  const Vector2d rim(0, s.radius);
  const double outline =
      std::min(segment_distance(q, rim, {height, 0}), segment_distance(q, {0, 0}, rim));
  const bool inside = q.x() > 0 && q.x() < height && q.y() < s.radius * (1 - q.x() / height);
  return inside ? -outline : outline;
}

inline double distance(const haarlight::renderer::Torus& s, const Vector3d& p) {
  const Vector2d q = profile(s.center, s.axis, p);
  return std::hypot(q.x(), q.y() - s.major_radius) - s.minor_radius;
}

inline double distance(const haarlight::renderer::Shape& shape, const Vector3d& p) {
  return std::visit([&](const auto& s) { return distance(s, p); }, shape);
}

enum class Answer { Miss, Hit, Unclear };

struct Found {
  Answer answer = Answer::Unclear;
  double t = 0;
};

/// First surface point along origin + t·direction (unit) with t < far; Unclear where the ray
/// grazes.
inline Found follow(const haarlight::renderer::Shape& shape, const Vector3d& origin,
                    const Vector3d& direction, double far) {
  double t = 0;
  for (int i = 0; i < 2000; ++i) {
    const double d = std::abs(distance(shape, origin + t * direction));
    if (d < 1e-11 * (1 + far))
      return {Answer::Hit, t};
    t += d;
    if (t > far)
      return {Answer::Miss, t};
  }
  return {Answer::Unclear, t};
}

/// Outward unit normal by finite differences of the distance.
inline Vector3d normal(const haarlight::renderer::Shape& shape, const Vector3d& p, double step) {
  Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Vector3d h = step * Vector3d::Unit(i);
    gradient[i] = distance(shape, p + h) - distance(shape, p - h);
  }
  return gradient.normalized();
}

/// Random points and directions from a fixed seed.
class Random {
public:
  explicit Random(unsigned seed) : m_generator(seed) {}
  float between(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(m_generator);
  }
  haarlight::Vec3 point(float size) {
    return {between(-size, size), between(-size, size), between(-size, size)};
  }
  haarlight::Vec3 direction() {
    for (;;) {
      const haarlight::Vec3 v = point(1);
      if (v.norm() > 0.1F && v.norm() < 1)
        return v.normalized();
    }
  }

private:
  std::mt19937 m_generator;
};

} // namespace reference
