// The paper's product: the stored trees of the nearest entries of two tables, multiplied and
// cached.

#include "samplers/kinds.h"
#include "samplers/product_tree_sampler.h"
#include "samplers/table_cells.h"

#include <wavelet/base/error.h>
#include <wavelet/product/synchronous_product.h>

namespace haarlight::renderer {
namespace {

class TableSampler : public ProductTreeSampler {
public:
  explicit TableSampler(const Light& light) : m_table(*light.rotated_table()) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    const TableCells cells = nearest_cells(m_table, point, material);
    m_frame = entry_frame(m_table, cells);
    m_product = &cached(cells, material);
  }

private:
  /// Direct-mapped: what neighbouring pixels share is found again, and memory stays bounded.
  static constexpr std::size_t cache_size = 64;

  struct Cached {
    const Material* material = nullptr;
    TableCells cells;
    wavelet::ProductTree product;
  };

  std::uint32_t hash(const TableCells& cells) const {
    const int index = cells.light_row * m_table.info().columns + cells.light_column;
    return hash_words(
        hash_words(static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(cells.theta)),
        static_cast<std::uint32_t>(cells.roll));
  }

  const wavelet::ProductTree& cached(const TableCells& cells, const Material& material) {
    Cached& place = m_cache[hash(cells) % cache_size];
    if (place.material == &material && place.cells == cells)
      return place.product;
    const RollEntry entry = roll_entry(*material.roll_table(), cells);
    const wavelet::TreeFactor factors[] = {
        wavelet::TreeFactor(m_table.tree(cells.light_column, cells.light_row)),
        wavelet::TreeFactor(entry.tree, entry.symmetry)};
    place = {&material, cells, m_builder.build(factors)};
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
