#pragma once
// Vectors, colours and orthonormal frames shared by the whole toolkit.
//
// World axes are those of Debevec's probes: right +x, up +y, forward −z. Directions are unit
// vectors pointing away from the surface.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace haarlight {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;
/// Linear RGB with Rec. 709 primaries.
using Rgb = Eigen::Array3f;

/// Rec. 709 weights of luminance.
inline constexpr float luminance_weights[3] = {0.2126F, 0.7152F, 0.0722F};

inline float luminance(const Rgb& c) {
  return luminance_weights[0] * c[0] + luminance_weights[1] * c[1] + luminance_weights[2] * c[2];
}

/// A right-handed orthonormal frame; t, b, n are the local x, y, z axes given in the outer frame.
struct Frame {
  Vec3 t = Vec3::UnitX();
  Vec3 b = Vec3::UnitY();
  Vec3 n = Vec3::UnitZ();

  Vec3 to_local(const Vec3& v) const { return {t.dot(v), b.dot(v), n.dot(v)}; }
  Vec3 to_outer(const Vec3& v) const { return v.x() * t + v.y() * b + v.z() * n; }
};

/// A frame about a unit axis, a function of the axis alone; it jumps where z changes sign (Duff et
/// al. 2017).
inline Frame frame_about(const Vec3& n) {
  const float sign = std::copysign(1.0F, n.z());
  const float a = -1.0F / (sign + n.z());
  const float c = n.x() * n.y() * a;
  return {{1.0F + sign * n.x() * n.x() * a, sign * c, -sign * n.x()},
          {c, sign + n.y() * n.y() * a, -n.y()},
          n};
}

/// Mirror image of `w` about the unit axis `n`: 2(n·w)n − w.
inline Vec3 mirror(const Vec3& w, const Vec3& n) { return 2.0F * n.dot(w) * n - w; }

/// The reflection frame of the two map sets for one shading point: z = the mirror direction of
/// `wo` about `n`, and the normal lies in the half plane x ≥ 0, y = 0, so that
/// n = (sin θ_r, 0, cos θ_r) in it. At θ_r → 0 the roll is undefined and any frame about z will do.
struct ReflectionFrame {
  Frame frame;
  float cos_theta_r = 1; ///< n·ω_r = n·ω_o
  float sin_theta_r = 0;
};

inline ReflectionFrame reflection_frame(const Vec3& n, const Vec3& wo) {
  ReflectionFrame result;
  const Vec3 z = mirror(wo, n).normalized();
  result.cos_theta_r = n.dot(z);
  const Vec3 across = n - result.cos_theta_r * z;
  result.sin_theta_r = across.norm();
  if (result.sin_theta_r < 1e-6F) {
    result.frame = frame_about(z);
    return result;
  }
  result.frame.n = z;
  result.frame.t = across / result.sin_theta_r;
  result.frame.b = z.cross(result.frame.t);
  return result;
}

} // namespace haarlight
