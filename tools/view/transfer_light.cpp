#include <view/transfer_light.h>

#include <view/transfer_packing.h>

#include <wavelet/base/parallel.h>

namespace haarlight::view {

using namespace renderer;

TransferLight::TransferLight(const Transfer& transfer, const SceneDescription& scene,
                             const std::vector<FilmPoint>& points)
    : m_width(transfer.width()), m_height(transfer.height()), m_shown(scene.light.background),
      m_light(scene.light, SourceLookups().probe), m_map(m_light, transfer.resolution()),
      m_points(points) {}

PackedScene TransferLight::turned(const Eigen::Matrix3f& turn) const {
  PackedScene packed = pack_coefficients(wavelet::DenseCoefficients(m_map.map(turn)));
  packed.textures.push_back(surroundings(turn));
  return packed;
}

PackedTexture TransferLight::surroundings(const Eigen::Matrix3f& turn) const {
  std::vector<float> rgba(4 * m_points.size());
  const Eigen::Matrix3f back = turn.transpose();
  parallel_ranges(m_points.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (m_shown && m_points[i].hit.object < 0)
        Eigen::Map<Rgb>(rgba.data() + 4 * i) =
            m_light.radiance(m_light.to_light(back * -m_points[i].wo));
  });
  return packed_texture("surroundings", Texel::Rgba32F, m_width, m_height, rgba);
}

} // namespace haarlight::view
