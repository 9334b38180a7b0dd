#include <wavelet/tree/compare.h>

#include "tree/map_batches.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace haarlight::wavelet {
namespace {

using Colour = Eigen::Array3d;

constexpr double mean_floor = 0.1; ///< of the set's mean, for relative errors of dark maps

double weighted(const Colour& c) {
  return luminance_weights[0] * c[0] + luminance_weights[1] * c[1] + luminance_weights[2] * c[2];
}

/// part / whole; nothing differs by nothing, and something from nothing without bound.
double ratio(double part, double whole) {
  if (part == 0)
    return 0;
  return whole > 0 ? part / whole : std::numeric_limits<double>::infinity();
}

/// Squared norm of the three differences of averages that the wavelets of one square hold.
double detail_energy(const Colour& q0, const Colour& q1, const Colour& q2, const Colour& q3) {
  const Colour upper = q0 + q1;
  const Colour lower = q2 + q3;
  const Colour upper_step = q0 - q1;
  const Colour lower_step = q2 - q3;
  return (weighted((upper_step + lower_step).square()) + weighted((upper - lower).square()) +
          weighted((upper_step - lower_step).square())) /
         16;
}

/// Visits the squares of two maps depth first, so that no transformed copy is needed.
class PairWalk {
public:
  PairWalk(const Map& a, const Map& b)
      : m_a(a), m_b(b), m_depth(std::countr_zero(static_cast<unsigned>(a.size))) {
    m_result.difference.levels.resize(static_cast<std::size_t>(m_depth));
  }

  MapDifference run() {
    const Averages whole = square(0, 0, 0);
    Difference& sums = m_result.difference;
    sums.mean = {weighted(whole.error.square()), weighted(whole.reference.square())};
    double area = 1;
    for (LevelDifference& level : sums.levels) {
      level.difference *= area;
      level.reference *= area;
      area /= 4;
    }
    sums.squared_error *= area;
    sums.energy *= area;
    m_result.mean_a = weighted(whole.reference);
    m_result.mean_b = weighted(whole.reference + whole.error);
    return m_result;
  }

private:
  struct Averages {
    Colour reference;
    Colour error;
  };

  Averages square(int level, int x, int y) {
    if (level == m_depth)
      return pixel(x, y);
    const Averages q0 = square(level + 1, 2 * x, 2 * y);
    const Averages q1 = square(level + 1, 2 * x + 1, 2 * y);
    const Averages q2 = square(level + 1, 2 * x, 2 * y + 1);
    const Averages q3 = square(level + 1, 2 * x + 1, 2 * y + 1);
    LevelDifference& sums = m_result.difference.levels[static_cast<std::size_t>(level)];
    sums.difference += detail_energy(q0.error, q1.error, q2.error, q3.error);
    sums.reference += detail_energy(q0.reference, q1.reference, q2.reference, q3.reference);
    return {0.25 * ((q0.reference + q1.reference) + (q2.reference + q3.reference)),
            0.25 * ((q0.error + q1.error) + (q2.error + q3.error))};
  }

  Averages pixel(int x, int y) {
    const Colour reference = m_a.at(x, y).cast<double>();
    const Colour error = m_b.at(x, y).cast<double>() - reference;
    Difference& sums = m_result.difference;
    sums.squared_error += weighted(error.square());
    sums.energy += weighted(reference.square());
    sums.peak = std::max(sums.peak, reference.abs().maxCoeff());
    const double largest = error.abs().maxCoeff();
    if (largest > sums.largest_error) {
      sums.largest_error = largest;
      m_result.x = x;
      m_result.y = y;
    }
    return {reference, error};
  }

  const Map& m_a;
  const Map& m_b;
  int m_depth;
  MapDifference m_result;
};

void add(LevelDifference& sum, const LevelDifference& part) {
  sum.difference += part.difference;
  sum.reference += part.reference;
}

void scale(LevelDifference& sum, double factor) {
  sum.difference *= factor;
  sum.reference *= factor;
}

/// Averages of two maps of a set.
struct Means {
  double a;
  double b;
};

/// Puts the maps' differences together, in their order.
class SetSum {
public:
  explicit SetSum(const SetInfo& info) : m_columns(info.columns) {}

  void add(const MapDifference& map) {
    const MapPlace place = place_of(m_means.size());
    Difference& sum = m_result.difference;
    const Difference& part = map.difference;
    if (m_means.empty() || part.largest_error > sum.largest_error) {
      sum.largest_error = part.largest_error;
      m_result.largest = place;
      m_result.x = map.x;
      m_result.y = map.y;
    }
    if (m_means.empty() || part.squared_error > m_result.worst_difference.squared_error) {
      m_result.worst = place;
      m_result.worst_difference = part;
    }
    add_sums(part);
    m_means.push_back({map.mean_a, map.mean_b});
  }

  SetDifference result() {
    const double share = 1 / static_cast<double>(m_means.size());
    Difference& sum = m_result.difference;
    sum.squared_error *= share;
    sum.energy *= share;
    scale(sum.mean, share);
    for (LevelDifference& level : sum.levels)
      scale(level, share);
    m_result.maps = static_cast<int>(m_means.size());
    judge_means();
    return m_result;
  }

private:
  MapPlace place_of(std::size_t index) const {
    return {static_cast<int>(index) % m_columns, static_cast<int>(index) / m_columns};
  }

  void add_sums(const Difference& part) {
    Difference& sum = m_result.difference;
    sum.squared_error += part.squared_error;
    sum.energy += part.energy;
    sum.peak = std::max(sum.peak, part.peak);
    wavelet::add(sum.mean, part.mean);
    sum.levels.resize(part.levels.size());
    for (std::size_t l = 0; l < part.levels.size(); ++l)
      wavelet::add(sum.levels[l], part.levels[l]);
  }

  void judge_means() {
    Means sum = {0, 0};
    double magnitude = 0;
    for (const Means& means : m_means) {
      sum.a += means.a;
      sum.b += means.b;
      magnitude += std::abs(means.a);
    }
    m_result.mean_error =
        std::copysign(ratio(std::abs(sum.b - sum.a), std::abs(sum.a)), sum.b - sum.a);
    const double floor = mean_floor * magnitude / static_cast<double>(m_means.size());
    for (std::size_t i = 0; i < m_means.size(); ++i) {
      const Means& means = m_means[i];
      const double error = ratio(std::abs(means.b - means.a), std::max(std::abs(means.a), floor));
      if (error > m_result.worst_mean_error) {
        m_result.worst_mean_error = error;
        m_result.worst_mean = place_of(i);
      }
    }
  }

  int m_columns;
  SetDifference m_result;
  std::vector<Means> m_means;
};

} // namespace

double LevelDifference::l2() const { return std::sqrt(difference); }

double LevelDifference::relative_l2() const { return std::sqrt(ratio(difference, reference)); }

double Difference::l2() const { return std::sqrt(squared_error); }

double Difference::relative_l2() const { return std::sqrt(ratio(squared_error, energy)); }

double Difference::relative_linf() const { return ratio(largest_error, peak); }

double Difference::psnr() const {
  return squared_error > 0 ? 20 * std::log10(peak / l2()) : std::numeric_limits<double>::infinity();
}

MapDifference compare_maps(const Map& a, const Map& b) {
  assert(a.size == b.size && std::has_single_bit(static_cast<unsigned>(a.size)));
  return PairWalk(a, b).run();
}

SetDifference compare_sets(const MapSource& a, const MapSource& b, const Progress& progress) {
  const SetInfo& info = a.info();
  assert(info.size == b.info().size && info.columns == b.info().columns &&
         info.rows == b.info().rows);
  SetSum sum(info);
  for_each_map<MapDifference>(
      info, 8, progress,
      [&](const MapPlace& place, MapDifference& slot) {
        slot = compare_maps(a.make(place.column, place.row), b.make(place.column, place.row));
      },
      [&](const MapDifference& slot) { sum.add(slot); });
  return sum.result();
}

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
