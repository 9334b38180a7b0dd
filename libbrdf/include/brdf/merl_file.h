#pragma once
// The file format of the MERL measurements (Matusik et al. 2003, "A data-driven reflectance
// model").
//
// Little-endian: int32[3] bins of θ_h, θ_d, φ_d; then three planes R, G, B of float64 values, index
// φ_d + n_φ·(θ_d + 90·θ_h). A value is f_r / scale, in sr⁻¹, without cosine; it is the value at the
// centre of its bin. Negative values mark invalid cells (a direction below the horizon). Bin k of
// θ_h spans π/2·[(k/90)², ((k+1)/90)²]; θ_d has 90 equal bins of [0, π/2]; φ_d 180 of [0, π)
// (reciprocity folds the rest) or 360 of [0, 2π). Very old files with linear θ_h cannot be
// distinguished.

#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

namespace haarlight::brdf {

inline constexpr int merl_theta_h_bins = 90;
inline constexpr int merl_theta_d_bins = 90;
inline constexpr int merl_phi_d_bins = 180;
/// The variant without the reciprocity fold.
inline constexpr int merl_unfolded_phi_d_bins = 360;

/// Angles of bin centres, radians.
inline double theta_h_centre(int bin) {
  const double root = (bin + 0.5) / merl_theta_h_bins;
  return root * root * (std::numbers::pi / 2);
}
inline double theta_d_centre(int bin) {
  return (bin + 0.5) / merl_theta_d_bins * (std::numbers::pi / 2);
}
/// For either number of bins: both have one per degree.
inline double phi_d_centre(int bin) { return (bin + 0.5) / merl_phi_d_bins * std::numbers::pi; }

/// f_r of channel c in sr⁻¹ = raw value · merl_scale[c].
inline constexpr double merl_scale[3] = {1.00 / 1500, 1.15 / 1500, 1.66 / 1500};

/// A whole file in memory, as raw values.
struct MerlTable {
  int phi_d_bins = merl_phi_d_bins; ///< 180 or 360
  std::vector<double> raw;          ///< 3 planes of plane_size() values

  explicit MerlTable(int phi_bins = merl_phi_d_bins)
      : phi_d_bins(phi_bins), raw(3 * plane_size()) {}

  std::size_t plane_size() const {
    return static_cast<std::size_t>(merl_theta_h_bins) * merl_theta_d_bins *
           static_cast<std::size_t>(phi_d_bins);
  }
  /// Index of a cell inside a plane.
  std::size_t cell(int theta_h, int theta_d, int phi_d) const {
    const int index = (theta_h * merl_theta_d_bins + theta_d) * phi_d_bins + phi_d;
    return static_cast<std::size_t>(index);
  }
  double value(int channel, std::size_t cell_index) const {
    return raw[static_cast<std::size_t>(channel) * plane_size() + cell_index];
  }
};

/// @throws Error(Input) if the file is unreadable, has other dimensions (each wrong one is named)
/// or
///         not exactly 12 + 24·n bytes, or holds NaN, infinity or values beyond 1e30
///         (with the byte offset)
MerlTable read_merl(const std::string& path);

/// Writes atomically. @throws Error(Output)
void write_merl(const std::string& path, const MerlTable& table);

} // namespace haarlight::brdf
