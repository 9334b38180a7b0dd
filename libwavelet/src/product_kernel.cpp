#include "product_kernel.h"

#include <wavelet/cpu_clones.h>
#include <wavelet/sphere_map.h>

namespace haarlight::wavelet::detail {
namespace {

/// No square of level l reaches further than this times 2^-l radians from its centre.
constexpr float square_radius = 4.4F;

/// The quadrants' squares, as lanes: centres in the light's square, and where those lie in the
/// reflectance's.
struct Lanes {
  int count = 0;
  float side[Pyramid::Places::capacity];
  float height[Pyramid::Places::capacity]; ///< above the horizon, sine
  Pyramid::Places places;
};

void gather(std::span<const Family> families, const Pyramid& pyramid, Lanes& lanes) {
  lanes.count = 4 * static_cast<int>(families.size());
  for (std::size_t f = 0; f < families.size(); ++f) {
    const Family& family = families[f];
    const float side = power_of_two(-family.level - 1);
    for (unsigned q = 0; q < 4; ++q) {
      const std::size_t i = 4 * f + q;
      lanes.side[i] = side;
      lanes.places.u[i] =
          (static_cast<float>(2 * family.x + static_cast<int>(q & 1U)) + 0.5F) * side;
      lanes.places.v[i] =
          (static_cast<float>(2 * family.y + static_cast<int>(q >> 1U)) + 0.5F) * side;
      pyramid.set_level(lanes.places, i, family.level + 1);
    }
  }
}

/// From points of the light's square to points of the reflectance's.
void rotate(const ReflectionFrame& r, Lanes& lanes) {
  for (int i = 0; i < lanes.count; ++i) {
    float wx = 0;
    float wy = 0;
    float wz = 0;
    square_to_sphere(lanes.places.u[i], lanes.places.v[i], wx, wy, wz);
    const float x = r.frame.t.x() * wx + r.frame.t.y() * wy + r.frame.t.z() * wz;
    const float y = r.frame.b.x() * wx + r.frame.b.y() * wy + r.frame.b.z() * wz;
    const float z = r.frame.n.x() * wx + r.frame.n.y() * wy + r.frame.n.z() * wz;
    lanes.height[i] = r.sin_theta_r * x + r.cos_theta_r * z;
    sphere_to_square(x, y, z, lanes.places.u[i], lanes.places.v[i]);
  }
}

/// The reflectance over a family's quadrants, those above the horizon.
void look_up(const RotatedReflectance& reflectance, const Lanes& lanes, std::size_t first,
             Quadrants& quadrants) {
  quadrants.visible = 0;
  for (unsigned q = 0; q < 4; ++q) {
    const std::size_t i = first + q;
    quadrants.reflectance[q] = Float4{};
    if (!(lanes.height[i] > -square_radius * lanes.side[i]))
      continue;
    quadrants.visible |= 1U << q;
    quadrants.reflectance[q] = reflectance.pyramid->lookup(reflectance.entry0, reflectance.entry1,
                                                           reflectance.blend, lanes.places, i);
  }
}

/// Weights and errors, from averages of light and reflectance.
void weigh(Float4 floor, int level, int finest_level, Quadrants& quadrants) {
  auto [lr, lg, lb, l0] = quadrants.light;
  auto [br, bg, bb, deviation] = quadrants.reflectance;
  transpose(lr, lg, lb, l0);
  transpose(br, bg, bb, deviation);
  const Float4 zero = {};
  const Float4 r = larger(br, zero + floor[0]) * luminance_lanes[0];
  const Float4 g = larger(bg, zero + floor[1]) * luminance_lanes[1];
  const Float4 b = larger(bb, zero + floor[2]) * luminance_lanes[2];
  const Int4 above = (Int4{1, 2, 4, 8} & static_cast<int>(quadrants.visible)) != 0;
  quadrants.density = select(above, larger(lr * r + lg * g + lb * b, zero), zero);
  const Float4 relative = deviation / (r + g + b + 1e-30F);
  const float area = level < finest_level ? power_of_two(-2 * level) : 0.0F;
  quadrants.error = area * quadrants.density * relative * relative;
}

} // namespace

HAARLIGHT_CPU_CLONES void weigh_families(const TreeView& light,
                                         const RotatedReflectance& reflectance, Float4 floor,
                                         std::span<const Family> families, Quadrants* out) {
  const Pyramid& pyramid = *reflectance.pyramid;
  Lanes lanes;
  gather(families, pyramid, lanes);
  rotate(reflectance.reflection, lanes);
  pyramid.place(lanes.places, lanes.count);
  for (std::size_t f = 0; f < families.size(); ++f) {
    const Family& family = families[f];
    look_up(reflectance, lanes, 4 * f, out[f]);
    out[f].light.fill(family.light);
    if (family.node != no_node)
      out[f].light = light.details(family.node).children(family.light);
    for (unsigned q = 0; q < 4; ++q)
      out[f].children[q] = light.child(family.node, q);
    weigh(floor, family.level + 1, pyramid.levels(), out[f]);
  }
}

} // namespace haarlight::wavelet::detail
