#pragma once
// What both product samplers share: drawing from a product tree that lies in some frame.

#include <renderer/samplers/sampler.h>

#include <wavelet/product/product_tree.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::renderer {

/// prepare() of the derived sampler sets m_product, and m_frame to the frame of the product's
/// square.
class ProductTreeSampler : public Sampler {
public:
  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    m_descents.resize(out.size());
    if (m_product->empty()) {
      std::ranges::fill(out, DirectionSample{Vec3::UnitZ(), 0});
      return;
    }
    m_product->sample(m_points, m_descents);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {m_frame.to_outer(wavelet::square_to_sphere(wavelet::end_point(m_descents[i]))),
                m_descents[i].pdf / wavelet::sphere_area};
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    const Vec2 p = wavelet::sphere_to_square(m_frame.to_local(direction));
    return m_product->pdf(p.x(), p.y()) / wavelet::sphere_area;
  }

  std::optional<Rgb> unshadowed() const override {
    return Rgb(m_product->integral() * wavelet::sphere_area);
  }

  std::size_t leaves() const override { return m_product->leaf_count(); }

protected:
  const wavelet::ProductTree* m_product = nullptr;
  Frame m_frame;

private:
  std::vector<Vec2> m_points;
  std::vector<wavelet::Descent> m_descents;
};

} // namespace haarlight::renderer
