// The paper's product: the stored trees of the nearest entries of two tables, multiplied and
// cached.

#include "kinds.h"
#include "product_tree_sampler.h"

#include <probe/probe_maps.h>
#include <wavelet/error.h>
#include <wavelet/sphere_map.h>
#include <wavelet/synchronous_product.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

int cell_of(float coordinate, int cells) {
  return std::clamp(static_cast<int>(coordinate * static_cast<float>(cells)), 0, cells - 1);
}

/// Index of the EM cell of a mirror direction, the same for all points that share it.
struct LightCell {
  int column;
  int row;
  Frame frame;
};

class TableSampler : public ProductTreeSampler {
public:
  explicit TableSampler(const Light& light) : m_table(*light.rotated_table()) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    const LightCell cell = light_cell(point);
    m_frame = cell.frame;
    const TreeTable& rolls = *material.roll_table();
    const Vec3 n = m_frame.to_local(point.n);
    const float theta_r = arctangent(std::sqrt(n.x() * n.x() + n.y() * n.y()), n.z());
    const float phi = arctangent(n.y(), n.x());
    const int column = cell_of(theta_r * (2.0F / pi), rolls.info().columns);
    const int roll = cell_of(phi / (2.0F * pi) + (phi < 0 ? 1.0F : 0.0F), rolls.info().rolls);
    m_product = &cached(cell, material, column, roll);
  }

private:
  /// Direct-mapped: what neighbouring pixels share is found again, and memory stays bounded.
  static constexpr std::size_t cache_size = 64;

  struct Cached {
    const Material* material = nullptr;
    int light_cell = -1;
    int column = -1;
    int roll = -1;
    wavelet::ProductTree product;
  };

  LightCell light_cell(const ShadingPoint& point) const {
    const Vec2 p = wavelet::sphere_to_square(point.reflection.frame.n);
    const int cells = m_table.info().columns;
    const int column = cell_of(p.x(), cells);
    const int row = cell_of(p.y(), cells);
    return {column, row, probe::light_frame(column, row, cells)};
  }

  const wavelet::ProductTree& cached(const LightCell& cell, const Material& material, int column,
                                     int roll) {
    const int index = cell.row * m_table.info().columns + cell.column;
    const std::uint32_t hash = hash_words(
        hash_words(static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(column)),
        static_cast<std::uint32_t>(roll));
    Cached& place = m_cache[hash % cache_size];
    if (place.material == &material && place.light_cell == index && place.column == column &&
        place.roll == roll)
      return place.product;
    const TreeTable& rolls = *material.roll_table();
    const wavelet::StoredRoll stored = wavelet::stored_roll(rolls.info(), roll);
    const wavelet::TreeFactor light(m_table.tree(cell.column, cell.row));
    const wavelet::TreeFactor lobe(rolls.tree(column, stored.row), stored.symmetry);
    const wavelet::Factor* const factors[] = {&light, &lobe};
    place = {&material, index, column, roll, m_builder.build(factors)};
    return place.product;
  }

  const TreeTable& m_table;
  wavelet::SynchronousProduct m_builder;
  std::vector<Cached> m_cache = std::vector<Cached>(cache_size);
};

} // namespace

std::unique_ptr<SamplerFactory> make_product_table_factory(const LoadedScene& scene,
                                                           const SamplerOptions& /*options*/) {
  return simple_factory<TableSampler>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
