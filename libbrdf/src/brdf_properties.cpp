#include <brdf/brdf_properties.h>

#include <wavelet/base/elementary.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haarlight::brdf {
namespace {

constexpr int steps_per_bin = 6;                             // of θ_h
constexpr int ring_size = 128;                               // half vectors of one θ_h
constexpr double widest_step = 0.4 * std::numbers::pi / 180; // of θ_o

struct Ring {
  float cosine[ring_size];
  float sine[ring_size];
};

Ring azimuth_ring() {
  Ring ring{};
  for (int i = 0; i < ring_size; ++i) {
    const SineCosine s = sine_cosine(2 * std::numbers::pi * (i + 0.5) / ring_size);
    ring.cosine[i] = static_cast<float>(s.cosine);
    ring.sine[i] = static_cast<float>(s.sine);
  }
  return ring;
}

/// The mirror images of ω_o in the plane y = 0 about one batch of half vectors at angle θ_h.
/// @return h·ω_o of each
std::array<float, batch_capacity> mirror_about_ring(const Ring& ring, int begin,
                                                    const SineCosine& h, const SineCosine& o,
                                                    DirectionBatch& batch) {
  const auto h_sine = static_cast<float>(h.sine);
  const auto h_cosine = static_cast<float>(h.cosine);
  const auto o_sine = static_cast<float>(o.sine);
  const auto o_cosine = static_cast<float>(o.cosine);
  std::array<float, batch_capacity> h_wo{};
  for (int i = 0; i < batch_capacity; ++i) {
    const float hx = h_sine * ring.cosine[begin + i];
    const float hy = h_sine * ring.sine[begin + i];
    const float dot = hx * o_sine + h_cosine * o_cosine;
    batch.wi[0][i] = 2 * dot * hx - o_sine;
    batch.wi[1][i] = 2 * dot * hy;
    batch.wi[2][i] = 2 * dot * h_cosine - o_cosine;
    batch.wo[0][i] = o_sine;
    batch.wo[1][i] = 0;
    batch.wo[2][i] = o_cosine;
    h_wo[static_cast<std::size_t>(i)] = dot;
  }
  batch.count = batch_capacity;
  return h_wo;
}

/// Sum over a ring of half vectors of f_r · (h·ω_o), times cos θ_i if asked for.
Eigen::Array3d ring_sum(const MeasuredBrdf& brdf, const Ring& ring, const SineCosine& h,
                        const SineCosine& o, bool cosine) {
  Float4 sum{};
  for (int begin = 0; begin < ring_size; begin += batch_capacity) {
    DirectionBatch batch;
    const auto h_wo = mirror_about_ring(ring, begin, h, o, batch);
    Float4 values[batch_capacity];
    brdf.evaluate(batch, values);
    for (int i = 0; i < batch_capacity; ++i) {
      const float dot = std::max(h_wo[static_cast<std::size_t>(i)], 0.0F);
      sum += values[i] * (cosine ? dot * batch.wi[2][i] : dot);
    }
  }
  return {static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])};
}

/// The integral for one outgoing direction.
Eigen::Array3d albedo_at(const MeasuredBrdf& brdf, double theta_o, bool cosine) {
  const Ring ring = azimuth_ring();
  const SineCosine o = sine_cosine(theta_o);
  constexpr int steps = steps_per_bin * merl_theta_h_bins;
  Eigen::Array3d total = Eigen::Array3d::Zero();
  for (int k = 0; k < steps; ++k) {
    const double root = (k + 0.5) / steps; // θ_h = π/2 root², dθ_h = π root d(root)
    const SineCosine h = sine_cosine(0.5 * std::numbers::pi * root * root);
    total += ring_sum(brdf, ring, h, o, cosine) * (h.sine * std::numbers::pi * root / steps);
  }
  return total * (4 * 2 * std::numbers::pi / ring_size);
}

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

Rgb directional_albedo(const MeasuredBrdf& brdf, double theta_begin, double theta_end,
                       bool cosine) {
  const int steps =
      std::max(1, static_cast<int>(std::ceil((theta_end - theta_begin) / widest_step)));
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int i = 0; i < steps; ++i)
    sum += albedo_at(brdf, theta_begin + (theta_end - theta_begin) * (i + 0.5) / steps, cosine);
  return (sum / steps).cast<float>();
}

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
