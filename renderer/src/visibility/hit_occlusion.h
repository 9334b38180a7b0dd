#pragma once
// What is in the light's way at a hit, as rays tell.

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <wavelet/product/adaptive_product.h>

namespace haarlight::renderer::detail {

class HitOcclusion final : public wavelet::Occlusion {
public:
  /// @param shapes, light must outlive this
  HitOcclusion(const ShapeSet& shapes, const Light& light) : m_shapes(shapes), m_light(light) {}

  /// @param hit must live until the next call; its normal points to the side that is seen
  void set_shading_point(const Hit& hit) { m_hit = &hit; }

  /// Below the surface nothing counts as hidden: what lies there is no light's way.
  void find(std::span<const Vec3> directions, std::span<std::uint8_t> hidden) const override {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const Vec3 w = m_light.to_world(directions[i]);
      hidden[i] = m_hit->normal.dot(w) > 0 && m_shapes.occluded(leave(*m_hit, w)) ? 1 : 0;
    }
  }

private:
  const ShapeSet& m_shapes;
  const Light& m_light;
  const Hit* m_hit = nullptr;
};

} // namespace haarlight::renderer::detail
