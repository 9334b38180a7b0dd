#include "brdf_test_support.h"

#include <brdf/brdf_maps.h>
#include <brdf/tabulate.h>

#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <numbers>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;
using wavelet::Fold;
using wavelet::Map;

namespace {

constexpr double half_pi = std::numbers::pi / 2;

MeasuredBrdf glossy() {
  return MeasuredBrdf(tabulate(Ggx{Rgb(0.1F, 0.2F, 0.3F), Rgb::Constant(0.3F), 0.25}));
}

/// The middle of part i of the unit interval.
double middle(int i, int parts) { return (i + 0.5) / parts; }

/// f_r cos of one pixel of one cell by brute force: dense samples of pixel and cell, in the frame
/// the set documents.
Rgb brute_pixel(const MeasuredBrdf& brdf, int size, int x, int y, double theta_begin,
                double theta_end, double phi_begin, double phi_end) {
  constexpr int fine = 12;
  constexpr int cell_steps = 6;
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int k = 0; k < cell_steps * cell_steps; ++k) {
    const double t = theta_begin + (theta_end - theta_begin) * middle(k % cell_steps, cell_steps);
    const double p = phi_begin + (phi_end - phi_begin) * middle(k / cell_steps, cell_steps);
    const Vec3 n =
        Eigen::Vector3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t))
            .cast<float>();
    const Frame frame = frame_about(n);
    const Vec3 wo = frame.to_local(mirror(Vec3::UnitZ(), n));
    for (int s = 0; s < fine * fine; ++s) {
      const auto u = static_cast<float>((x + middle(s % fine, fine)) / size);
      const auto v = static_cast<float>((y + middle(s / fine, fine)) / size);
      const Vec3 w = frame.to_local(wavelet::square_to_sphere(Vec2(u, v)));
      sum += (brdf.evaluate(w, wo) * std::max(w.z(), 0.0F)).cast<double>();
    }
  }
  return (sum / (cell_steps * cell_steps * fine * fine)).cast<float>();
}

Map mirrored(const Map& map) {
  Map result(map.size);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x)
      result.set(y, x, map.at(x, y));
  return result;
}

double relative_difference(const Map& a, const Map& b) {
  double difference = 0;
  double total = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    difference += std::abs(static_cast<double>(a.rgb[i] - b.rgb[i]));
    total += static_cast<double>(std::abs(b.rgb[i]));
  }
  return difference / total;
}

BrdfMapOptions options(int size, int theta, int roll) {
  BrdfMapOptions result;
  result.size = size;
  result.theta = theta;
  result.roll = roll;
  return result;
}

} // namespace

TEST_CASE("map pixels hold the average over pixel and cell in the documented frame", "[maps]") {
  const MeasuredBrdf brdf = glossy();
  BrdfMapOptions wanted = options(16, 8, 12);
  wanted.fold = Fold::None;
  wanted.supersample = 32;
  const BrdfMaps maps(brdf, wanted);
  for (const auto& [column, row] : {std::pair(0, 0), {3, 1}, {5, 2}, {6, 7}}) {
    const Map map = maps.make(column, row);
    Map expected(16);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x)
        expected.set(x, y,
                     brute_pixel(brdf, 16, x, y, column * half_pi / 8, (column + 1) * half_pi / 8,
                                 row * half_pi / 3, (row + 1) * half_pi / 3));
    CHECK(relative_difference(map, expected) < 0.015);
  }
}

TEST_CASE("the set without rolls lies at roll 0", "[maps]") {
  const MeasuredBrdf brdf = glossy();
  const Map map = BrdfMaps(brdf, options(16, 16, 1)).make(9, 0);
  Map expected(16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      expected.set(x, y,
                   brute_pixel(brdf, 16, x, y, 9 * half_pi / 16, 10 * half_pi / 16, 0.0, 0.0));
  CHECK(relative_difference(map, expected) < 0.02);
  // The normal lies towards +x, so light leaving there is above the horizon and its opposite is
  // not.
  CHECK(map.at(12, 8)[0] > 0);
}

TEST_CASE("a quarter turn of the roll is an exact permutation of pixels", "[maps]") {
  BrdfMapOptions wanted = options(32, 6, 8);
  wanted.fold = Fold::None;
  const BrdfMaps all(glossy(), wanted);
  const BrdfMaps folded(glossy(), options(32, 6, 8));
  REQUIRE(folded.info().fold == Fold::Rotations);
  REQUIRE(folded.info().rows == 2);
  for (int row = 0; row < 8; ++row) {
    Map base = folded.make(4, row % 2);
    for (int turn = 0; turn < row / 2; ++turn) {
      Map next(32);
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
          next.set(31 - y, x, base.at(x, y)); // (x, y) → (−y, x) about the middle
      base = next;
    }
    REQUIRE(all.make(4, row).rgb == base.rgb);
  }
}

TEST_CASE("mirrored rolls of a symmetric table are mirrored maps", "[maps]") {
  const MerlTable noisy = tabulate(Ggx{Rgb::Constant(0.1F), Rgb::Constant(0.5F), 0.3}, {0.2, 3});
  BrdfMapOptions half = options(32, 6, 16);
  half.fold = Fold::Mirrors;
  half.supersample = 16;
  const BrdfMaps mirrors(MeasuredBrdf(noisy), half);
  REQUIRE(mirrors.info().rows == 2);
  BrdfMapOptions full = half;
  full.fold = Fold::Rotations;
  const BrdfMaps rotations(MeasuredBrdf(noisy).symmetrised(), full);
  REQUIRE(rotations.info().rows == 4);
  for (int row = 0; row < 2; ++row) {
    CHECK(mirrors.make(3, row).rgb == rotations.make(3, row).rgb);
    // Same cell, other samples: equal but for what averaging over the cell leaves.
    CHECK(relative_difference(mirrored(mirrors.make(3, row)), rotations.make(3, 3 - row)) < 0.02);
  }
}

TEST_CASE("the integral of a map is the albedo, narrow lobes included", "[maps]") {
  // A lobe of a tenth of a degree in maps whose pixels are 3 degrees wide.
  const MeasuredBrdf sharp(tabulate(Ggx{Rgb::Zero(), Rgb::Constant(0.9F), 0.004}));
  for (const int size : {32, 64}) {
    const BrdfMaps maps(sharp, options(size, 16, 1));
    for (const int column : {0, 5, 11}) {
      const double sum = wavelet::map_mean(maps.make(column, 0))[0] * 4 * std::numbers::pi;
      CHECK(sum == Approx(static_cast<double>((*maps.integral(column, 0))[0])).epsilon(0.01));
    }
  }
}

TEST_CASE("a constant BRDF integrates to its albedo with and without the cosine", "[maps]") {
  for (const bool cosine : {true, false}) {
    BrdfMapOptions wanted = options(64, 8, 1);
    wanted.cosine = cosine;
    const BrdfMaps maps(MeasuredBrdf(constant_table(0.5 / std::numbers::pi)), wanted);
    CHECK(maps.info().cosine == cosine);
    const double sum = wavelet::map_mean(maps.make(5, 0))[1] * 4 * std::numbers::pi;
    CHECK(sum == Approx(cosine ? 0.5 : 1.0).epsilon(3e-3));
    CHECK((*maps.integral(5, 0))[1] == Approx(cosine ? 0.5 : 1.0).epsilon(3e-3));
  }
}

TEST_CASE("very fine sampling stays in the cell", "[maps]") {
  BrdfMapOptions wanted = options(4, 8, 1);
  const BrdfMaps coarse(glossy(), wanted);
  wanted.supersample = 1024;
  CHECK(relative_difference(BrdfMaps(glossy(), wanted).make(2, 0), coarse.make(2, 0)) < 0.02);
}

TEST_CASE("maps do not depend on threads or on the order they are made in", "[maps]") {
  const BrdfMaps maps(glossy(), options(32, 8, 1));
  std::vector<Map> together(8, Map(0));
  parallel_for(8, [&](std::size_t i) {
    together[i] = maps.make(static_cast<int>(i), 0);
    REQUIRE(maps.integral(static_cast<int>(i), 0));
  });
  for (int i = 7; i >= 0; --i)
    CHECK(maps.make(i, 0).rgb == together[static_cast<std::size_t>(i)].rgb);
}

TEST_CASE("the set describes itself", "[maps]") {
  const BrdfMaps table(glossy(), options(0, 4, 64));
  const wavelet::SetInfo& info = table.info();
  CHECK(info.kind == wavelet::SetKind::Brdf);
  CHECK(info.size == 128);
  CHECK(info.columns == 4);
  CHECK(info.rows == 16);
  CHECK(info.rolls == 64);
  CHECK(info.units == "sr^-1");
  CHECK(info.provenance.get("source") == "table");
  CHECK(info.provenance.get("source_hash").size() == 16);
  CHECK_FALSE(info.frame.empty());
  CHECK(BrdfMaps(glossy()).info().size == 512);
}

TEST_CASE("map options that make no sense are refused", "[maps]") {
  CHECK_FALSE(validate(BrdfMapOptions()));
  CHECK(validate(options(100, 64, 1)));
  CHECK(validate(options(64, 0, 1)));
  CHECK(validate(options(64, 64, 0)));
  BrdfMapOptions wanted = options(64, 8, 6);
  CHECK_FALSE(validate(wanted));
  wanted.fold = Fold::Rotations;
  CHECK(validate(wanted));
  wanted.roll = 12;
  CHECK_FALSE(validate(wanted));
  wanted.fold = Fold::Mirrors;
  CHECK(validate(wanted));
}
