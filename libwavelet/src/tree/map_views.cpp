#include <wavelet/tree/map_views.h>

#include <cassert>
#include <utility>

namespace haarlight::wavelet {
namespace {

/// What views have in common: the set they look at, and what they say of themselves.
class View : public MapSource {
public:
  explicit View(SharedMaps maps) : m_maps(std::move(maps)), m_info(m_maps->info()) {}
  const SetInfo& info() const override { return m_info; }

protected:
  const MapSource& maps() const { return *m_maps; }
  SetInfo& own_info() { return m_info; }

private:
  SharedMaps m_maps;
  SetInfo m_info;
};

class TreeMaps : public MapSource {
public:
  explicit TreeMaps(std::shared_ptr<const TreeSet> trees) : m_trees(std::move(trees)) {}
  const SetInfo& info() const override { return m_trees->info(); }
  Map make(int column, int row) const override {
    return m_trees->tree(column, row).reconstruct(m_trees->levels());
  }

private:
  std::shared_ptr<const TreeSet> m_trees;
};

class ShrunkMaps : public View {
public:
  ShrunkMaps(SharedMaps source, int size) : View(std::move(source)) { own_info().size = size; }
  Map make(int column, int row) const override {
    Map map = maps().make(column, row);
    while (map.size > info().size)
      map = halved(map);
    return map;
  }
};

class UnfoldedMaps : public View {
public:
  explicit UnfoldedMaps(SharedMaps source) : View(std::move(source)) {
    own_info().rows = info().rolls;
    own_info().fold = Fold::None;
  }
  Map make(int column, int row) const override {
    const StoredRoll stored = stored_roll(maps().info(), row);
    return turned(maps().make(column, stored.row), stored.symmetry);
  }
};

class OneMap : public View {
public:
  OneMap(SharedMaps source, int column, int row)
      : View(std::move(source)), m_column(column), m_row(row) {
    SetInfo& own = own_info();
    own.columns = own.rows = own.rolls = 1;
    own.fold = Fold::None;
  }
  Map make(int /*column*/, int /*row*/) const override { return maps().make(m_column, m_row); }

private:
  int m_column;
  int m_row;
};

class LuminanceMaps : public View {
public:
  using View::View;
  Map make(int column, int row) const override {
    Map map = maps().make(column, row);
    for (std::size_t i = 0; i < map.rgb.size(); i += 3) {
      Eigen::Map<Rgb> pixel(map.rgb.data() + i);
      pixel = Rgb::Constant(luminance(pixel));
    }
    return map;
  }
};

} // namespace

Map turned(const Map& stored, const SquareSymmetry& symmetry) {
  Map map(stored.size);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      int from_x = x;
      int from_y = y;
      for (int i = 0; i < symmetry.turns; ++i)
        from_y = map.size - 1 - std::exchange(from_x, from_y);
      if (symmetry.mirrored)
        std::swap(from_x, from_y);
      map.set(x, y, stored.at(from_x, from_y));
    }
  return map;
}

SharedMaps tree_maps(std::shared_ptr<const TreeSet> trees) {
  return std::make_shared<TreeMaps>(std::move(trees));
}

SharedMaps shrunk(SharedMaps maps, int size) {
  assert(size <= maps->info().size);
  return std::make_shared<ShrunkMaps>(std::move(maps), size);
}

SharedMaps unfolded(SharedMaps maps) { return std::make_shared<UnfoldedMaps>(std::move(maps)); }

SharedMaps one_map(SharedMaps maps, int column, int row) {
  assert(column >= 0 && column < maps->info().columns && row >= 0 && row < maps->info().rows);
  return std::make_shared<OneMap>(std::move(maps), column, row);
}

SharedMaps in_luminance(SharedMaps maps) {
  return std::make_shared<LuminanceMaps>(std::move(maps));
}

} // namespace haarlight::wavelet
