#pragma once
// Visibility of squares from a hit, by rays.

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/sphere_map.h>

namespace haarlight::renderer::detail {

/// Traces a ray through the centre of each square. Where that is hidden, the visible fraction is
/// that of the centres of the four quadrants.
class HitOcclusion final : public wavelet::SquareVisibility {
public:
  /// @param shapes, light must outlive this
  HitOcclusion(const ShapeSet& shapes, const Light& light) : m_shapes(shapes), m_light(light) {}

  /// @param hit must live until the next call; its normal points to the side that is seen
  void set_shading_point(const Hit& hit) { m_hit = &hit; }

  void query_visibility(std::span<const wavelet::Square> squares,
                        std::span<wavelet::SquareView> views) override {
    for (std::size_t i = 0; i < squares.size(); ++i) {
      views[i].seen = 1;
      if (is_visible(squares[i]))
        continue;
      views[i].seen = 0;
      for (unsigned q = 0; q < 4; ++q)
        views[i].seen += is_visible(squares[i].quadrant(q)) ? 0.25F : 0.0F;
    }
  }

private:
  /// Of a square's centre; directions below the surface count as visible.
  bool is_visible(const wavelet::Square& square) const {
    const Vec3 w = m_light.to_world(wavelet::square_to_sphere(square.centre()));
    return m_hit->normal.dot(w) <= 0 || !m_shapes.occluded(leave(*m_hit, w));
  }

  const ShapeSet& m_shapes;
  const Light& m_light;
  const Hit* m_hit = nullptr;
};

} // namespace haarlight::renderer::detail
