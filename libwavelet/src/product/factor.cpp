#include <wavelet/product/factor.h>

#include "product/synchronous_kernel.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::wavelet {

detail::TreeTurn::TreeTurn(const SquareSymmetry& symmetry)
    : stored{symmetry.to_stored(0U), symmetry.to_stored(1U), symmetry.to_stored(2U),
             symmetry.to_stored(3U)},
      plain(symmetry.turns == 0 && !symmetry.mirrored), swaps((stored[0] ^ stored[1]) == 2),
      sign_x((stored[0] & (swaps ? 2U : 1U)) == 0 ? 1.0F : -1.0F),
      sign_y((stored[0] & (swaps ? 1U : 2U)) == 0 ? 1.0F : -1.0F) {}

TreeFactor::TreeFactor(const TreeView& view, const SquareSymmetry& symmetry)
    : m_view(view), m_turn(symmetry) {}

void TreeFactor::split(const FactorSquares& squares, const FactorQuadrants& out) const {
  detail::split_tree(m_view, m_turn, squares, out);
}

void ConstantFactor::split(const FactorSquares& squares, const FactorQuadrants& out) const {
  std::fill_n(out.mean, 4 * squares.count, m_value);
  std::fill_n(out.detail, 4 * squares.count, no_node);
}

Float4 RotatedFactor::mean() const {
  const Pyramid& pyramid = *m_reflectance.pyramid;
  const Float4 near = pyramid.lookup(m_reflectance.entry0, 0, 0.5F, 0.5F);
  const Float4 far = pyramid.lookup(m_reflectance.entry1, 0, 0.5F, 0.5F);
  return near + (far - near) * m_reflectance.blend;
}

void RotatedFactor::split(const FactorSquares& squares, const FactorQuadrants& out) const {
  const Pyramid& pyramid = *m_reflectance.pyramid;
  Pyramid::Places places;
  for (std::size_t i = 0; i < squares.count; ++i) {
    const int level = squares.place[i].level + 1;
    const float side = power_of_two(-level);
    for (unsigned q = 0; q < 4; ++q) {
      const Vec2 centre(
          (2 * static_cast<float>(squares.place[i].column) + static_cast<float>(q & 1U) + 0.5F) *
              side,
          (2 * static_cast<float>(squares.place[i].row) + static_cast<float>(q >> 1U) + 0.5F) *
              side);
      const Vec3 w = square_to_sphere(centre);
      const Vec2 p = sphere_to_square(m_reflectance.reflection.frame.to_local(w));
      places.u[q] = p.x();
      places.v[q] = p.y();
      pyramid.set_level(places, q, level);
    }
    Pyramid::place(places, 4);
    for (std::size_t q = 0; q < 4; ++q) {
      out.mean[4 * i + q] = pyramid.lookup(m_reflectance.entry0, m_reflectance.entry1,
                                           m_reflectance.blend, places, q);
      out.detail[4 * i + q] = level < pyramid.levels() ? 0 : no_node;
    }
  }
}

} // namespace haarlight::wavelet
