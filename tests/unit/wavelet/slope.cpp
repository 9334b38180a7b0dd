// Linear functions over squares: what they draw has the density they say.

#include <catch2/catch.hpp>

#include <wavelet/tree/descent.h>

#include <array>

using namespace haarlight;
using namespace haarlight::wavelet;

TEST_CASE("points warped by a slope have its density, and quadrants its means") {
  const auto [x, y] = GENERATE(table<float, float>(
      {{0.0F, 0.0F}, {0.5F, -0.25F}, {-1.2F, 0.0F}, {0.9F, 1.0F}, {-0.001F, 1.9F}}));
  const Slope slope = {x, y};
  constexpr int side = 400;
  std::array<double, 4> share = {};
  for (int i = 0; i < side * side; ++i) {
    float s = (static_cast<float>(i % side) + 0.5F) / side;
    float t = (static_cast<float>(i / side) + 0.5F) / side;
    const float density = warp(slope, s, t);
    REQUIRE((s >= 0 && s < 1 && t >= 0 && t < 1));
    REQUIRE(density == Approx(slope.at(s, t)).margin(1e-5));
    share[(s < 0.5F ? 0 : 1) + (t < 0.5F ? 0 : 2)] += 4.0 / (side * side);
  }
  const Float4 means = slope.quadrants();
  for (std::size_t q = 0; q < 4; ++q) {
    const float mean = means[q];
    CHECK(share[q] == Approx(mean).margin(0.01));
    const Slope within = slope.in_quadrant(mean);
    const float s0 = (q & 1U) != 0 ? 0.5F : 0.0F;
    const float t0 = (q & 2U) != 0 ? 0.5F : 0.0F;
    for (const float s : {0.0F, 0.3F, 1.0F})
      CHECK(mean * within.at(s, 0.7F) == Approx(slope.at(s0 + 0.5F * s, t0 + 0.35F)).margin(1e-5));
  }
}

TEST_CASE("a warp keeps the order of its points, and their stratification with it") {
  const Slope slope = {1.3F, -0.6F};
  float last = -1;
  for (int i = 0; i < 1000; ++i) {
    float s = static_cast<float>(i) / 1000;
    float t = 0.5F;
    warp(slope, s, t);
    REQUIRE(s > last);
    last = s;
  }
}
