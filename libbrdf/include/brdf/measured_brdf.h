#pragma once
// A measured isotropic BRDF: a MERL table, looked up by directions.
//
// Local frame: z = the surface normal; wi and wo are unit vectors pointing away from the surface.
// Values are f_r in sr⁻¹, without cosine; 0 where wi or wo is not above the horizon.

#include <brdf/merl_file.h>

#include <wavelet/base/geometry.h>
#include <wavelet/base/lanes.h>
#include <wavelet/base/trigonometry.h>

#include <array>
#include <cstddef>
#include <new>
#include <string>
#include <vector>

#include <sys/mman.h>

namespace haarlight::brdf {

// Half and difference angles (Rusinkiewicz 1998) of two directions, and where they fall in a MERL
// table. All templates take a float or Float4 and give the same bits for both. With H = wi + wo and
// e = wi − wo (which is perpendicular to H):
//   θ_h = angle of H from the normal, in [0, π/2)
//   θ_d = angle between wi and H, in [0, π/2]
//   φ_d = azimuth of wi about H, measured from the plane of H and the normal
// Each is computed as the angle of a point (x, y), which stays exact where an arccosine cancels:
// the lobe of polished metal is less than a degree wide.

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

enum class Lookup {
  Trilinear, ///< between bin centres, over valid cells only; θ clamps, φ_d wraps
  Nearest    ///< the bin the angles fall in, as the measurements' original reader does
};

/// `trilinear` or `nearest`.
const char* lookup_name(Lookup lookup);

/// Largest number of direction pairs in a batch.
inline constexpr int batch_capacity = 64;

/// Pairs of directions in the local frame, by component.
struct DirectionBatch {
  int count = 0;
  float wi[3][batch_capacity];
  float wo[3][batch_capacity];
};

/// Half and difference angles of many pairs, as points (x, y).
struct HalfDifferenceBatch {
  int count = 0;
  float theta_h_y[batch_capacity], theta_h_x[batch_capacity];
  float theta_d_y[batch_capacity], theta_d_x[batch_capacity];
  float phi_d_y[batch_capacity], phi_d_x[batch_capacity];

  void move(int from, int to) {
    theta_h_y[to] = theta_h_y[from];
    theta_h_x[to] = theta_h_x[from];
    theta_d_y[to] = theta_d_y[from];
    theta_d_x[to] = theta_d_x[from];
    phi_d_y[to] = phi_d_y[from];
    phi_d_x[to] = phi_d_x[from];
  }
};

/// Allocator for tables of many MB that are accessed at random: on large pages where the system has
/// them.
template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t page = std::size_t{1} << 21U;

  LargePages() = default;
  template <class U>
  explicit LargePages(const LargePages<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    void* memory = ::operator new (count * sizeof(T), std::align_val_t{page});
    ::madvise(memory, count * sizeof(T), MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) {
    ::operator delete (memory, std::align_val_t{page});
  }
  template <class U>
  bool operator==(const LargePages<U>& /*other*/) const {
    return true;
  }
};

class MeasuredBrdf {
public:
  /// @throws Error(Input) as read_merl()
  explicit MeasuredBrdf(const std::string& path, Lookup lookup = Lookup::Trilinear);

  /// @param name of the table in provenance
  explicit MeasuredBrdf(const MerlTable& table, Lookup lookup = Lookup::Trilinear,
                        const std::string& name = "table");

  /// f_r in sr⁻¹.
  Rgb evaluate(const Vec3& local_wi, const Vec3& local_wo) const;

  /// The same for many pairs: identical bits, several times faster.
  /// @param values `batch.count` results: R, G, B and 1 (0 where no valid cell is near)
  void evaluate(const DirectionBatch& batch, Float4* values) const;

  /// f_r of many half and difference angles, horizon or not.
  void evaluate(const HalfDifferenceBatch& batch, Float4* values) const;

  /// f_r at a table position, horizon or not: R, G, B in sr⁻¹ and 1; all 0 if no cell near is
  /// valid.
  Float4 at(const TablePosition<float>& place) const;

  /// One cell: R, G, B in sr⁻¹ and 1, or all 0 if it is invalid.
  Float4 cell(int theta_h, int theta_d, int phi_d) const {
    return m_cells[static_cast<std::size_t>(index(theta_h, theta_d, phi_d + 1))].value;
  }

  /// Fraction of the table's cells that are invalid: negative in some channel. About 0.21 of a
  /// measurement's cells lie below the horizon.
  double invalid_fraction() const { return m_invalid_fraction; }
  /// The same by channel.
  const std::array<double, 3>& negative_fractions() const { return m_negative_fractions; }

  Lookup lookup() const { return m_lookup; }
  int phi_d_bins() const { return m_phi_d_bins; }
  /// Whether reciprocity is built into the table.
  bool folded() const { return m_phi_d_bins == merl_phi_d_bins; }
  /// Base name of the file.
  const std::string& name() const { return m_name; }
  /// Hash of the raw values, 16 hexadecimal digits.
  const std::string& hash() const { return m_hash; }

  /// The same table averaged over its bilateral mirror images, f(φ_d) and f(π − φ_d); where only
  /// one of the two is valid, it alone.
  MeasuredBrdf symmetrised() const;

private:
  /// One cell: the colour is zero where it is invalid, so that Σ w·rgb / Σ w·valid interpolates
  /// over valid cells only.
  struct Cell {
    Float4 value;
  };

  /// Index of a cell in m_cells.
  int index(int theta_h, int theta_d, int padded_phi_d) const {
    return (theta_h * merl_theta_d_bins + theta_d) * (m_phi_d_bins + 2) + padded_phi_d;
  }
  void fill(const MerlTable& table);
  void pad_rows();
  Float4 interpolate(int cell, float theta_h_weight, float theta_d_weight,
                     float phi_d_weight) const;

  Lookup m_lookup;
  int m_phi_d_bins;
  std::string m_name;
  std::string m_hash;
  double m_invalid_fraction = 0;
  std::array<double, 3> m_negative_fractions = {};
  /// Rows of φ_d with one cell of wrap-around at either end.
  std::vector<Cell, LargePages<Cell>> m_cells;
};

} // namespace haarlight::brdf
