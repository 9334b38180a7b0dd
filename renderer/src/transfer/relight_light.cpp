#include <renderer/transfer/relight.h>

#include <renderer/transfer/turned_light.h>

#include <wavelet/base/parallel.h>
#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>

namespace haarlight::renderer {
namespace {

constexpr std::size_t pixels_at_once = 512;

class LightRelighter : public Relighter {
public:
  LightRelighter(const Transfer& transfer, const SceneDescription& scene)
      : m_transfer(transfer), m_shown(scene.light.background),
        m_light(scene.light, SourceLookups().probe), m_turned(m_light, transfer.resolution()),
        m_points(film_points(scene, transfer.width(), transfer.height())) {}

  Film make(const Change& change) override {
    const Eigen::Matrix3f turn = turn_of(change.rotate);
    const wavelet::DenseCoefficients light(m_turned.map(turn));
    Film film(m_transfer.width(), m_transfer.height());
    parallel_ranges(film.count(), pixels_at_once, [&](std::size_t begin, std::size_t end) {
      std::vector<Rgb> means(end - begin);
      light.inner_products(m_transfer.trees().subspan(begin, end - begin), means);
      for (std::size_t i = begin; i < end; ++i)
        film.set_color(i, m_points[i].hit.object < 0
                              ? background(m_points[i], turn)
                              : Rgb((means[i - begin] * wavelet::sphere_area).max(0.0F)));
    });
    return film;
  }

private:
  Rgb background(const FilmPoint& point, const Eigen::Matrix3f& turn) const {
    return m_shown ? m_light.radiance(m_light.to_light(turn.transpose() * -point.wo))
                   : Rgb(Rgb::Zero());
  }

  const Transfer& m_transfer;
  bool m_shown;
  Light m_light;
  TurnedLight m_turned;
  std::vector<FilmPoint> m_points;
};

} // namespace

std::unique_ptr<Relighter> light_relighter(const Transfer& transfer,
                                           const SceneDescription& scene) {
  return std::make_unique<LightRelighter>(transfer, scene);
}

} // namespace haarlight::renderer
