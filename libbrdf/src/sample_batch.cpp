#include "sample_batch.h"

#include "cpu_clones.h"

#include <wavelet/sphere_map.h>

namespace haarlight::brdf {
namespace {

/// Bin k of θ_h ends at the angle k² / bins2_per_radian.
constexpr float bins2_per_radian = 8100.0F * 2.0F / pi;
/// The widest step of θ_h between samples, in bins, squared: a part for the peak and one that grows
/// with the distance from it, where tables are smooth. Radians².
constexpr float step2_at_peak = 0.02F;
constexpr float step2_per_radian = 1.0F;
/// At grazing angles lobes are cos θ_d times as wide; below this they are not followed.
constexpr float lowest_cosine_d = 0.2F;

/// Square of the sample spacing over that which the table asks for.
/// A bin of θ_h is about (2k + 1) / bins2_per_radian wide, k that of the least θ_h near the sample; a
/// step of θ_h is one of 2 cos θ_d in ω across the plane of incidence, and of 2 in it.
inline float needed_resolution(float tan_theta_h, float cos_theta_d, float spacing) {
  const float cosine_d = larger(cos_theta_d, lowest_cosine_d);
  const float theta_h = larger(smaller(tan_theta_h, 1.0F) - 0.4F * spacing / cosine_d, 0.0F);
  const float bins2 = step2_at_peak + step2_per_radian * theta_h;
  const float width = 2.0F * cosine_d / bins2_per_radian;
  return spacing * spacing /
         (bins2 * width * width * (4.0F * bins2_per_radian * theta_h + 1.0F));
}

} // namespace

/// With c = n·z, ω_o = 2c n − z, so that H = ω + ω_o = (ω − z) + 2c n: what H has across n is what the
/// small vector ω − z has, found without cancellation.
HAARLIGHT_CPU_CLONES void place_samples(SampleBatch& b) {
  HalfDifferenceBatch& angles = b.angles;
  for (int i = 0; i < b.count; ++i) {
    float x;
    float y;
    float z;
    wavelet::square_to_sphere(b.u[i], b.v[i], x, y, z);
    const float nx = b.normal[0][i];
    const float ny = b.normal[1][i];
    const float nz = b.normal[2][i];
    const float cosine = x * nx + y * ny + z * nz;
    const float dz = z - 1.0F;
    const float along = x * nx + y * ny + dz * nz;
    const float ax = x - along * nx;
    const float ay = y - along * ny;
    const float az = dz - along * nz;
    const float across = square_root(ax * ax + ay * ay + az * az);
    const float wi_wo = 2.0F * nz * cosine - z;
    const float h_length = square_root(larger(2.0F + 2.0F * wi_wo, 0.0F));
    b.cosine[i] = cosine;
    angles.theta_h_y[i] = across;
    angles.theta_h_x[i] = cosine + nz;
    angles.theta_d_y[i] = square_root(larger(2.0F - 2.0F * wi_wo, 0.0F));
    angles.theta_d_x[i] = h_length;
    angles.phi_d_y[i] = 2.0F * (nx * y - ny * x);
    angles.phi_d_x[i] = h_length * (nz - cosine);
    b.resolution[i] =
        needed_resolution(across / larger(cosine + nz, 1e-3F), 0.5F * h_length, b.spacing[i]);
  }
  angles.count = b.count;
}

} // namespace haarlight::brdf
