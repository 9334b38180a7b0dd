#pragma once
// Half and difference angles (Rusinkiewicz 1998) of two directions, and where they fall in a MERL
// table. All templates take a float or Float4 and give the same bits for both.
//
// Local frame: z = the surface normal; wi and wo are unit vectors pointing away from the surface.
// With H = wi + wo and e = wi − wo (which is perpendicular to H):
//   θ_h = angle of H from the normal, in [0, π/2)
//   θ_d = angle between wi and H, in [0, π/2]
//   φ_d = azimuth of wi about H, counted from the plane of H and the normal
// Each is taken as the angle of a point (x, y), which stays exact where an arccosine cancels: the
// lobe of polished metal is less than a degree wide.

#include <brdf/merl_file.h>

#include <wavelet/base/trigonometry.h>

namespace haarlight::brdf {

/// The three angles as points (x, y) of any length; the y of θ_h and θ_d are ≥ 0.
template <class F>
struct HalfDifference {
  F theta_h_y, theta_h_x;
  F theta_d_y, theta_d_x;
  F phi_d_y, phi_d_x;
};

/// @param wi, wo unit vectors as three components each
template <class F>
HalfDifference<F> half_difference(const F (&wi)[3], const F (&wo)[3]) {
  const F hx = wi[0] + wo[0];
  const F hy = wi[1] + wo[1];
  const F hz = wi[2] + wo[2];
  const F ex = wi[0] - wo[0];
  const F ey = wi[1] - wo[1];
  const F ez = wi[2] - wo[2];
  const F across = hx * hx + hy * hy;
  const F h_length = square_root(across + hz * hz);
  return {square_root(across),
          hz,
          square_root(ex * ex + ey * ey + ez * ez),
          h_length,
          hx * ey - hy * ex,
          -h_length * ez};
}

/// Continuous table coordinates: bin k covers [k, k + 1), its centre is k + ½.
template <class F>
struct TablePosition {
  F theta_h; ///< in [0, 90], proportional to the square root of the angle
  F theta_d; ///< in [0, 90]
  F phi_d;   ///< in [0, 180] with the reciprocity fold, else in [0, 360]
};

/// Rotates the φ_d point by 180° if its y is negative: swaps wi and wo.
template <class F>
void fold_reciprocity(HalfDifference<F>& angles) {
  const F zero = broadcast<F>(0);
  angles.phi_d_x = select(angles.phi_d_y < zero, -angles.phi_d_x, angles.phi_d_x);
  angles.phi_d_y = absolute(angles.phi_d_y);
}

/// The position from the three angles in radians; φ_d in (−π, π].
template <class F>
TablePosition<F> table_position(F theta_h, F theta_d, F phi_d) {
  const F zero = broadcast<F>(0);
  const F turned = select(phi_d < zero, phi_d + 2.0F * pi, phi_d);
  return {90.0F * square_root(theta_h * (2.0F / pi)), theta_d * (180.0F / pi),
          turned * (180.0F / pi)};
}

/// @param folded whether the table has the reciprocity fold (180 bins of φ_d)
template <class F>
TablePosition<F> table_position(HalfDifference<F> angles, bool folded) {
  if (folded)
    fold_reciprocity(angles);
  return table_position(arctangent(angles.theta_h_y, angles.theta_h_x),
                        arctangent(angles.theta_d_y, angles.theta_d_x),
                        arctangent(angles.phi_d_y, angles.phi_d_x));
}

/// The same bits for one pair of directions, faster: the three arctangents run side by side.
inline TablePosition<float> table_position_of_one(HalfDifference<float> angles, bool folded) {
  if (folded)
    fold_reciprocity(angles);
  const Float4 angle = arctangent(Float4{angles.theta_h_y, angles.theta_d_y, angles.phi_d_y, 0.0F},
                                  Float4{angles.theta_h_x, angles.theta_d_x, angles.phi_d_x, 1.0F});
  return table_position(angle[0], angle[1], angle[2]);
}

} // namespace haarlight::brdf
