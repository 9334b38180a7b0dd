#include "maps/sample_batch.h"

#include <wavelet/base/cpu_clones.h>

#include <wavelet/square/sphere_map.h>

namespace haarlight::brdf {
namespace {

/// Bin k of θ_h ends at the angle k² / bins2_per_radian.
constexpr float bins2_per_radian = 8100.0F * 2.0F / pi;
/// The widest step of θ_h between samples, in bins, squared: a part for the peak and one that grows
/// with the distance from it, where tables are smooth. Radians².
constexpr float step2_at_peak = 0.03F;
constexpr float step2_per_radian = 4.0F;
/// At grazing angles lobes are cos θ_d times as wide; below this they are not followed.
constexpr float lowest_cosine_d = 0.3F;

/// Square of the sample spacing over that which the table asks for, the same for all normals of the
/// cell: if finer samples were for some normals only, the average would lean towards the others.
/// θ_h is at least half the angle between ω and z. A bin of θ_h is about (2k + 1) /
/// bins2_per_radian wide; a step of θ_h is one of 2 cos θ_d in ω across the plane of incidence, and
/// of 2 in it.
inline float needed_resolution(float z, float wi_wo, float spacing) {
  const float cosine_d2 = larger(0.5F + 0.5F * wi_wo, lowest_cosine_d * lowest_cosine_d);
  const float theta_h = larger(square_root(larger(0.5F - 0.5F * z, 0.0F)) - 0.4F * spacing, 0.0F);
  const float bins2 = step2_at_peak + step2_per_radian * theta_h;
  return spacing * spacing * (0.25F * bins2_per_radian * bins2_per_radian) /
         (cosine_d2 * bins2 * (4.0F * bins2_per_radian * theta_h + 1.0F));
}

} // namespace

/// With c = n·z, ω_o = 2c n − z, so that H = ω + ω_o = (ω − z) + 2c n: what H has across n is what
/// the small vector ω − z has, found without cancellation.
HAARLIGHT_CPU_CLONES void place_samples(SampleBatch& b) {
  HalfDifferenceBatch& angles = b.angles;
  for (int i = 0; i < b.count; ++i) {
    float x = 0;
    float y = 0;
    float z = 0;
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
    const float wi_wo = 2.0F * nz * cosine - z;
    const float h_length = square_root(larger(2.0F + 2.0F * wi_wo, 0.0F));
    b.cosine[i] = cosine;
    angles.theta_h_y[i] = square_root(ax * ax + ay * ay + az * az);
    angles.theta_h_x[i] = cosine + nz;
    angles.theta_d_y[i] = square_root(larger(2.0F - 2.0F * wi_wo, 0.0F));
    angles.theta_d_x[i] = h_length;
    angles.phi_d_y[i] = 2.0F * (nx * y - ny * x);
    angles.phi_d_x[i] = h_length * (nz - cosine);
    const float middle_wi_wo = x * b.middle_wo[0] + y * b.middle_wo[1] + z * b.middle_wo[2];
    b.resolution[i] = needed_resolution(z, middle_wi_wo, b.spacing[i]);
  }
  angles.count = b.count;
}

} // namespace haarlight::brdf
