#include <brdf/tabulate.h>

#include <wavelet/base/elementary.h>
#include <wavelet/base/hash.h>
#include <wavelet/base/parallel.h>

#include <algorithm>

namespace haarlight::brdf {
namespace {

constexpr double lowest_model_cosine = 0.01;

/// Cosines of ω_i and ω_o at one cell centre: in the half-vector frame ω_i is the difference vector
/// d and ω_o its mirror image, and the normal is (−sin θ_h, 0, cos θ_h).
Angles cell_angles(const SineCosine& h, const SineCosine& d, const SineCosine& phi) {
  const double along = h.cosine * d.cosine;
  const double across = h.sine * d.sine * phi.cosine;
  return {along - across, along + across, h.sine, h.cosine, d.cosine};
}

/// Nearly normal, mean 0 and variance 1: the sum of twelve uniform 16-bit numbers.
double normal_deviate(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t sum = 0;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const std::uint64_t bits = splitmix64(splitmix64(seed) ^ (3 * counter + i));
    sum += (bits & 0xffffU) + ((bits >> 16U) & 0xffffU) + ((bits >> 32U) & 0xffffU) + (bits >> 48U);
  }
  return (static_cast<double>(sum) + 6) / 65536 - 6;
}

/// Log-normal, so that noise never makes a cell negative, which would mean invalid.
double noise_factor(const TabulateOptions& options, std::uint64_t counter) {
  if (options.noise <= 0)
    return 1;
  const double sigma = options.noise;
  return exponential(sigma * normal_deviate(options.seed, counter) - 0.5 * sigma * sigma);
}

void fill_cell(MerlTable& table, std::size_t cell, const AnalyticBrdf& model, Angles angles,
               const TabulateOptions& options) {
  const bool valid = std::min(angles.cos_i, angles.cos_o) > lowest_valid_cosine;
  angles.cos_i = std::max(angles.cos_i, lowest_model_cosine);
  angles.cos_o = std::max(angles.cos_o, lowest_model_cosine);
  const Rgb value = valid ? evaluate(model, angles) : Rgb::Zero();
  for (int c = 0; c < 3; ++c) {
    const std::size_t place = static_cast<std::size_t>(c) * table.plane_size() + cell;
    table.raw[place] =
        valid ? static_cast<double>(value[c]) / merl_scale[c] * noise_factor(options, place) : -1;
  }
}

} // namespace

MerlTable tabulate(const AnalyticBrdf& model, const TabulateOptions& options) {
  MerlTable table;
  parallel_for(merl_theta_h_bins, [&](std::size_t index) {
    const int i = static_cast<int>(index);
    const SineCosine h = sine_cosine(theta_h_centre(i));
    for (int j = 0; j < merl_theta_d_bins; ++j) {
      const SineCosine d = sine_cosine(theta_d_centre(j));
      for (int k = 0; k < merl_phi_d_bins; ++k)
        fill_cell(table, table.cell(i, j, k), model,
                  cell_angles(h, d, sine_cosine(phi_d_centre(k))), options);
    }
  });
  return table;
}

} // namespace haarlight::brdf
