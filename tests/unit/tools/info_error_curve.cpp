// haarinfo's error by coefficients kept, against sorting.
#include "fixture.h"

#include <info/page.h>

#include <wavelet/base/parallel.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace haarlight;

namespace {

double energy_of(Float4 d, int level) {
  return static_cast<double>(wavelet::lane_sum(d * d * wavelet::luminance_lanes)) /
         static_cast<double>(1U << 2U * static_cast<unsigned>(level));
}

/// Of all coefficients of a set of two trees, the largest first.
std::vector<double> sorted_energies(const wavelet::TreeSet& set) {
  std::vector<double> energies;
  for (int column = 0; column < 2; ++column) {
    std::uint32_t node = 0;
    for (int level = 0; level < set.levels(); ++level)
      for (auto left = set.level_nodes(column, 0, level); left > 0; --left) {
        const wavelet::Details details = set.tree(column, 0).details(node++);
        for (const Float4 d : {details.d1, details.d2, details.d3})
          energies.push_back(energy_of(d, level));
      }
  }
  std::sort(energies.rbegin(), energies.rend());
  return energies;
}

} // namespace

TEST_CASE("the error by coefficients kept is what sorting them gives", "[info]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  wavelet::CompressOptions options;
  options.threshold.criterion = wavelet::Criterion::L2;
  options.threshold.tolerance = 0;
  OutputFile file(path);
  wavelet::compress_set(testing::NumberedMaps(16, 2, 1), options, file);
  file.commit();
  const wavelet::TreeSet set(path);
  const std::vector<double> energies = sorted_energies(set);
  double all = energy_of(wavelet::to_lanes(set.tree(0, 0).mean), 0) +
               energy_of(wavelet::to_lanes(set.tree(1, 0).mean), 0);
  for (const double energy : energies)
    all += energy;

  const std::vector<info::KeptPoint> curve = info::error_curve(set, {{0, 0}, {1, 0}});
  REQUIRE(curve.size() > 20);
  CHECK(curve.back().error == 0);
  for (const info::KeptPoint& point : curve) {
    double rest = 0;
    for (std::size_t i = point.kept; i < energies.size(); ++i)
      rest += energies[i];
    CHECK(point.error == Approx(std::sqrt(rest / all)).margin(1e-7));
  }
  const ThreadLimit one(1);
  const std::vector<info::KeptPoint> again = info::error_curve(set, {{0, 0}, {1, 0}});
  REQUIRE(again.size() == curve.size());
  for (std::size_t i = 0; i < curve.size(); ++i)
    CHECK((again[i].kept == curve[i].kept && again[i].error == curve[i].error));
}
