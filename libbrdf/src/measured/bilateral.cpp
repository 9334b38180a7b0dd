#include <brdf/bilateral.h>

#include <wavelet/base/elementary.h>

#include <cmath>

namespace haarlight::brdf {
namespace {

double cell_luminance(const Float4& cell) {
  return static_cast<double>(luminance({cell[0], cell[1], cell[2]}));
}

/// Sums over one row of φ_d.
struct RowSums {
  double difference = 0;
  double total = 0;
};

RowSums row_sums(const MeasuredBrdf& brdf, int theta_h, int theta_d) {
  RowSums sums;
  const int bins = brdf.phi_d_bins();
  for (int i = 0; i < bins; ++i) {
    const Float4 here = brdf.cell(theta_h, theta_d, i);
    const Float4 there = brdf.cell(theta_h, theta_d, (merl_phi_d_bins - 1 - i + bins) % bins);
    if (here[3] == 0 || there[3] == 0)
      continue;
    sums.difference += std::abs(cell_luminance(here) - cell_luminance(there));
    sums.total += cell_luminance(here);
  }
  return sums;
}

/// Solid angle of a bin of θ_h times that of a bin of θ_d, up to a constant.
double row_weight(int theta_h, int theta_d) {
  const SineCosine h = sine_cosine(theta_h_centre(theta_h));
  const SineCosine d = sine_cosine(theta_d_centre(theta_d));
  return h.sine * (2 * theta_h + 1) * d.sine * d.cosine;
}

} // namespace

double bilateral_asymmetry(const MeasuredBrdf& brdf) {
  double difference = 0;
  double total = 0;
  for (int theta_h = 0; theta_h < merl_theta_h_bins; ++theta_h) {
    for (int theta_d = 0; theta_d < merl_theta_d_bins; ++theta_d) {
      const RowSums sums = row_sums(brdf, theta_h, theta_d);
      const double weight = row_weight(theta_h, theta_d);
      difference += weight * sums.difference;
      total += weight * sums.total;
    }
  }
  return total > 0 ? difference / total : 0;
}

} // namespace haarlight::brdf
