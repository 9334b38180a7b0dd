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

void set_square(const Pyramid& pyramid, int level, int x, int y, std::size_t i, Lanes& lanes) {
  const float side = power_of_two(-level);
  lanes.side[i] = side;
  lanes.places.u[i] = (static_cast<float>(x) + 0.5F) * side;
  lanes.places.v[i] = (static_cast<float>(y) + 0.5F) * side;
  pyramid.set_level(lanes.places, i, level);
}

void gather(std::span<const Family> families, const Pyramid& pyramid, Lanes& lanes) {
  lanes.count = 4 * static_cast<int>(families.size());
  for (std::size_t f = 0; f < families.size(); ++f)
    for (unsigned q = 0; q < 4; ++q)
      set_square(pyramid, families[f].level + 1, 2 * families[f].x + static_cast<int>(q & 1U),
                 2 * families[f].y + static_cast<int>(q >> 1U), 4 * f + q, lanes);
}

/// Leaves to lanes, up to a multiple of four with the last one again.
void gather(std::span<const ProductLeaf> leaves, const Pyramid& pyramid, Lanes& lanes) {
  lanes.count = (static_cast<int>(leaves.size()) + 3) / 4 * 4;
  for (std::size_t i = 0; i < static_cast<std::size_t>(lanes.count); ++i) {
    const ProductLeaf& leaf = leaves[std::min(i, leaves.size() - 1)];
    set_square(pyramid, leaf.level, leaf.x, leaf.y, i, lanes);
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
    const float nearest = lanes.height[i] + square_radius * lanes.side[i];
    if (!(nearest > -kept_shift))
      continue;
    quadrants.visible |= 1U << q;
    if (!(nearest > 0)) // in reach of points nearby, but dark here
      continue;
    quadrants.reflectance[q] = reflectance.pyramid->lookup(reflectance.entry0, reflectance.entry1,
                                                           reflectance.blend, lanes.places, i);
  }
}

/// Weights and errors, from averages of light and reflectance.
/// @param area of the squares that may be split further, else 0
void weigh(Float4 floor, Float4 area, Quadrants& quadrants) {
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
  quadrants.error = area * quadrants.density * relative * relative;
}

float splittable_area(const Pyramid& pyramid, int level) {
  return level < pyramid.levels() ? power_of_two(-2 * level) : 0.0F;
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
    if (family.node != no_node) {
      out[f].light = light.details(family.node).children(family.light);
      out[f].children = light.children(family.node);
    } else {
      out[f].light.fill(family.light);
      out[f].children.fill(no_node);
    }
    weigh(floor, Float4{} + splittable_area(pyramid, family.level + 1), out[f]);
  }
}

HAARLIGHT_CPU_CLONES void weigh_leaves(const RotatedReflectance& reflectance, Float4 floor,
                                       std::span<ProductLeaf> leaves, float* density,
                                       float* error) {
  const Pyramid& pyramid = *reflectance.pyramid;
  Lanes lanes;
  gather(leaves, pyramid, lanes);
  rotate(reflectance.reflection, lanes);
  pyramid.place(lanes.places, lanes.count);
  Quadrants four;
  for (std::size_t first = 0; first < leaves.size(); first += 4) {
    const std::size_t count = std::min<std::size_t>(4, leaves.size() - first);
    look_up(reflectance, lanes, first, four);
    Float4 area = {};
    for (std::size_t i = 0; i < 4; ++i) {
      const ProductLeaf& leaf = leaves[std::min(first + i, leaves.size() - 1)];
      four.light[i] = leaf.light;
      area[i] = splittable_area(pyramid, leaf.level);
    }
    weigh(floor, area, four);
    for (std::size_t i = 0; i < count; ++i) {
      leaves[first + i].reflectance = four.reflectance[i];
      density[first + i] = four.density[i];
      error[first + i] = four.error[i];
    }
  }
}

} // namespace haarlight::wavelet::detail
