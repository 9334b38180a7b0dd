// Differences of maps and sets against dense evaluation in double.
#include "random_map.h"
#include "temporary_folder.h"

#include <wavelet/base/parallel.h>
#include <wavelet/transform/compress.h>
#include <wavelet/transform/transform.h>
#include <wavelet/tree/compare.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <functional>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// Maps from a function of their indices.
class MadeMaps : public MapSource {
public:
  using Maker = std::function<Map(int column, int row)>;
  MadeMaps(SetInfo info, Maker maker) : m_info(std::move(info)), m_maker(std::move(maker)) {}
  const SetInfo& info() const override { return m_info; }
  Map make(int column, int row) const override { return m_maker(column, row); }

private:
  SetInfo m_info;
  Maker m_maker;
};

SetInfo grid(int size, int columns, int rows) {
  SetInfo info;
  info.size = size;
  info.columns = columns;
  info.rows = rows;
  return info;
}

CompressOptions keep(double tolerance, CoefficientType type, bool grey = false) {
  CompressOptions options;
  options.threshold.criterion = Criterion::L2;
  options.threshold.tolerance = tolerance;
  options.coefficients = type;
  options.luminance = grey;
  return options;
}

Map thresholded(const Map& map, double tolerance, CoefficientType type = CoefficientType::Half) {
  CompressReport report;
  const Tree tree = compress_map(map, keep(tolerance, type), report);
  return tree.view().reconstruct(tree.levels);
}

constexpr std::array<double, 3> weights = {0.2126F, 0.7152F, 0.0722F};

std::vector<double> difference_of(const Map& a, const Map& b) {
  std::vector<double> result;
  for (std::size_t i = 0; i < a.rgb.size(); ++i)
    result.push_back(static_cast<double>(b.rgb[i]) - static_cast<double>(a.rgb[i]));
  return result;
}

double mean_square(const std::vector<double>& pixels) {
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    sum += weights[i % 3] * pixels[i] * pixels[i];
  return sum / (static_cast<double>(pixels.size()) / 3);
}

/// Sum of squared L2-normalised coefficients of a level, by the library's transform in double.
double level_energy(std::vector<double> pixels, int size, int level) {
  haar_forward(pixels.data(), size, 3);
  double sum = 0;
  for (int y = 0; y < (1 << level); ++y)
    for (int x = 0; x < (1 << level); ++x)
      for (int m = 1; m <= 3; ++m)
        for (std::size_t c = 0; c < 3; ++c) {
          const double d = pixels[3 * coefficient_index(size, level, x, y, m) + c];
          sum += weights[c] * d * d;
        }
  return std::ldexp(sum, -2 * level);
}

void require_dense(const Map& a, const Map& b) {
  const Difference result = compare_maps(a, b).difference;
  const std::vector<double> error = difference_of(a, b);
  const std::vector<double> reference = difference_of(Map(a.size), a);
  CHECK(result.squared_error == Approx(mean_square(error)).epsilon(1e-12));
  CHECK(result.energy == Approx(mean_square(reference)).epsilon(1e-12));
  CHECK(result.relative_l2() ==
        Approx(std::sqrt(mean_square(error) / mean_square(reference))).epsilon(1e-12));
  REQUIRE(result.levels.size() == static_cast<std::size_t>(std::log2(a.size)));
  double error_sum = result.mean.difference;
  double reference_sum = result.mean.reference;
  for (std::size_t l = 0; l < result.levels.size(); ++l) {
    const int level = static_cast<int>(l);
    CHECK(result.levels[l].difference == Approx(level_energy(error, a.size, level)).epsilon(1e-10));
    CHECK(result.levels[l].reference ==
          Approx(level_energy(reference, a.size, level)).epsilon(1e-10));
    error_sum += result.levels[l].difference;
    reference_sum += result.levels[l].reference;
  }
  CHECK(error_sum == Approx(result.squared_error).epsilon(1e-12));
  CHECK(reference_sum == Approx(result.energy).epsilon(1e-12));
}

} // namespace

TEST_CASE("maps compare as plain sums over pixels and coefficients say") {
  for (const int size : {1, 2, 8, 64}) {
    const Map a = random_map(size, 3);
    require_dense(a, random_map(size, 4));
    require_dense(a, thresholded(a, 0.2));
    require_dense(a, thresholded(a, 0.02, CoefficientType::Float));
  }
}

TEST_CASE("the largest error of a channel is found, and its pixel") {
  const Map a = random_map(32, 5);
  Map b = a;
  b.rgb[b.offset(21, 6) + 2] -= 0.75F;
  b.rgb[b.offset(3, 30) + 1] += 0.5F;
  const MapDifference result = compare_maps(a, b);
  CHECK(result.difference.largest_error == Approx(0.75).epsilon(1e-5));
  CHECK(result.x == 21);
  CHECK(result.y == 6);
  const double peak = *std::max_element(a.rgb.begin(), a.rgb.end());
  CHECK(result.difference.peak == peak);
  CHECK(result.difference.relative_linf() == Approx(0.75 / peak).epsilon(1e-5));
  CHECK(result.difference.psnr() ==
        Approx(10 * std::log10(peak * peak / result.difference.squared_error)));
}

TEST_CASE("a map differs from itself by nothing, and from black by everything") {
  const Map map = random_map(16, 6);
  const Difference none = compare_maps(map, map).difference;
  CHECK(none.squared_error == 0);
  CHECK(none.relative_l2() == 0);
  CHECK(none.relative_linf() == 0);
  CHECK(std::isinf(none.psnr()));
  CHECK(compare_maps(map, Map(16)).difference.relative_l2() == 1);
  CHECK(std::isinf(compare_maps(Map(16), map).difference.relative_l2()));
  CHECK(compare_maps(Map(16), Map(16)).difference.relative_l2() == 0);
}

TEST_CASE("a set's figures are those of its maps together") {
  const SetInfo info = grid(16, 4, 3);
  const auto first = [](int column, int row) {
    return random_map(16, static_cast<unsigned>(10 * row + column));
  };
  const auto second = [&](int column, int row) {
    Map map = thresholded(first(column, row), 0.1);
    if (column == 2 && row == 1)
      for (float& value : map.rgb)
        value *= 1.5F;
    if (column == 3 && row == 2)
      map.rgb[map.offset(9, 4)] += 300;
    return map;
  };
  const MadeMaps a(info, first);
  const MadeMaps b(info, second);
  const SetDifference result = compare_sets(a, b);
  double squares = 0;
  double energy = 0;
  double last = 0;
  double mean_a = 0;
  double mean_b = 0;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      const MapDifference map = compare_maps(first(column, row), second(column, row));
      squares += map.difference.squared_error / 12;
      energy += map.difference.energy / 12;
      last += map.difference.levels.back().difference / 12;
      mean_a += map.mean_a;
      mean_b += map.mean_b;
    }
  CHECK(result.maps == 12);
  CHECK(result.difference.squared_error == Approx(squares).epsilon(1e-12));
  CHECK(result.difference.energy == Approx(energy).epsilon(1e-12));
  CHECK(result.difference.levels.back().difference == Approx(last).epsilon(1e-12));
  CHECK(result.mean_error == Approx(mean_b / mean_a - 1).epsilon(1e-9));
  CHECK(result.largest.column == 3);
  CHECK(result.largest.row == 2);
  CHECK(result.x == 9);
  CHECK(result.y == 4);
  CHECK(result.worst.column == 3);
  CHECK(result.worst.row == 2);
  CHECK(result.worst_mean.column == 2);
  CHECK(result.worst_mean.row == 1);
  CHECK(result.worst_mean_error == Approx(0.5).epsilon(1e-3));
}

TEST_CASE("a set's figures do not depend on the number of threads") {
  const MadeMaps a(grid(32, 9, 7), [](int column, int row) {
    return random_map(32, static_cast<unsigned>(9 * row + column));
  });
  const MadeMaps b(grid(32, 9, 7), [](int column, int row) {
    return random_map(32, static_cast<unsigned>(9 * row + column + 1));
  });
  std::vector<double> sums;
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    const SetDifference result = compare_sets(a, b);
    sums.push_back(result.difference.squared_error);
    sums.push_back(result.mean_error);
  }
  CHECK(sums[0] == sums[2]);
  CHECK(sums[1] == sums[3]);
}

TEST_CASE("a compressed file lies from its maps as far as compression said") {
  const TemporaryFolder folder;
  const auto maps = std::make_shared<MadeMaps>(grid(32, 3, 2), [](int column, int row) {
    return random_map(32, static_cast<unsigned>(10 * row + column));
  });
  for (const bool grey : {false, true}) {
    OutputFile file(folder.file("set.haar"));
    const CompressReport report =
        compress_set(*maps, keep(0.05, CoefficientType::Half, grey), file);
    file.commit();
    const SharedMaps trees = tree_maps(std::make_shared<const TreeSet>(folder.file("set.haar")));
    const SharedMaps reference = grey ? in_luminance(maps) : SharedMaps(maps);
    const Difference result = compare_sets(*reference, *trees).difference;
    CHECK(result.relative_l2() == Approx(report.relative_l2_error()).epsilon(1e-5));
    CHECK(result.relative_linf() == Approx(report.relative_linf_error()).epsilon(1e-5));
  }
}

TEST_CASE("a folded set unfolds into what its trees say at turned points") {
  for (const Fold fold : {Fold::Rotations, Fold::Mirrors}) {
    SetInfo info = grid(8, 2, fold == Fold::Rotations ? 4 : 2);
    info.kind = SetKind::Brdf;
    info.rolls = 16;
    info.fold = fold;
    const auto stored = std::make_shared<MadeMaps>(info, [](int column, int row) {
      return random_map(8, static_cast<unsigned>(10 * row + column));
    });
    const SharedMaps all = unfolded(stored);
    CHECK(all->info().rows == 16);
    CHECK(all->info().fold == Fold::None);
    for (int roll = 0; roll < 16; ++roll) {
      const StoredRoll place = stored_roll(info, roll);
      const Map whole = all->make(1, roll);
      const Map part = stored->make(1, place.row);
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          const Vec2 centre((static_cast<float>(x) + 0.5F) / 8, (static_cast<float>(y) + 0.5F) / 8);
          const Vec2 from = 8 * place.symmetry.to_stored(centre);
          const Rgb expected = part.at(static_cast<int>(from.x()), static_cast<int>(from.y()));
          REQUIRE((whole.at(x, y) == expected).all());
        }
    }
  }
}

TEST_CASE("a shrunk map holds averages, and one map of a set stands alone") {
  const auto maps = std::make_shared<MadeMaps>(grid(32, 3, 2), [](int column, int row) {
    return random_map(32, static_cast<unsigned>(10 * row + column));
  });
  const SharedMaps single = one_map(shrunk(maps, 8), 2, 1);
  CHECK(single->info().map_count() == 1);
  CHECK(single->info().size == 8);
  const Map small = single->make(0, 0);
  CompressReport report;
  const Tree tree = compress_map(random_map(32, 12), keep(0, CoefficientType::Float), report);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      REQUIRE((small.at(x, y) - tree.view().average(3, x, y)).abs().maxCoeff() < 5e-5F);
}
