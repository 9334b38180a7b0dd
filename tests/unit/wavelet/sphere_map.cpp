#include <wavelet/square/sphere_map.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

Vec3 random_direction(std::mt19937& generator) {
  std::normal_distribution<float> gauss;
  return Vec3(gauss(generator), gauss(generator), gauss(generator)).normalized();
}

} // namespace

TEST_CASE("trigonometry keeps to its error bounds") {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  double tangent = 0;
  double cosine = 0;
  double sine = 0;
  for (int i = 0; i < 200000; ++i) {
    const float x = uniform(generator);
    const float y = uniform(generator);
    tangent = std::max(tangent, std::abs(arctangent(y, x) - std::atan2(double(y), double(x))));
    if (std::abs(x) < 0.999F)
      cosine = std::max(cosine, std::abs(arccosine(x) - std::acos(double(x))));
    float s = 0;
    float c = 0;
    const float angle = 6.3F * y;
    sine_cosine(angle, s, c);
    sine = std::max(
        {sine, std::abs(s - std::sin(double(angle))), std::abs(c - std::cos(double(angle)))});
  }
  CHECK(tangent < 4e-7);
  CHECK(cosine < 4e-7);
  CHECK(sine < 5e-7);
  CHECK(arctangent(0.0F, 0.0F) == 0);
  CHECK(arccosine(2.0F) == 0);
}

TEST_CASE("the square covers the sphere, there and back") {
  std::mt19937 generator(2);
  float worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 w = random_direction(generator);
    const Vec2 p = sphere_to_square(w);
    CHECK((p.minCoeff() >= 0 && p.maxCoeff() <= 1));
    worst = std::max(worst, (square_to_sphere(p) - w).norm());
  }
  CHECK(worst < 2e-6F);
  CHECK(square_to_sphere(Vec2(0.5F, 0.5F)).isApprox(Vec3::UnitZ()));
  CHECK(square_to_sphere(Vec2(0, 0)).isApprox(-Vec3::UnitZ()));
  CHECK(square_to_sphere(Vec2(1, 0.5F)).isApprox(Vec3::UnitX(), 1e-6F));
  CHECK(square_to_sphere(Vec2(0.5F, 1)).isApprox(Vec3::UnitY(), 1e-6F));
}

TEST_CASE("equal squares cover equal solid angles") {
  std::mt19937 generator(3);
  int counts[64] = {};
  const int n = 640000;
  for (int i = 0; i < n; ++i) {
    const Vec2 p = sphere_to_square(random_direction(generator));
    ++counts[8 * std::min(7, static_cast<int>(8 * p.y())) +
             std::min(7, static_cast<int>(8 * p.x()))];
  }
  double chi_square = 0;
  for (const int count : counts)
    chi_square += std::pow(count - n / 64.0, 2) / (n / 64.0);
  CHECK(chi_square < 120); // 63 degrees of freedom: beyond is a chance of 1e-5
}

TEST_CASE("turns and mirrorings of the frame are those of the square") {
  std::mt19937 generator(4);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 w = random_direction(generator);
    const Vec2 p = sphere_to_square(w);
    const Vec2 turned = sphere_to_square(Vec3(-w.y(), w.x(), w.z()));
    const Vec2 mirrored = sphere_to_square(Vec3(w.y(), w.x(), w.z()));
    CHECK((turned - Vec2(1 - p.y(), p.x())).norm() < 1e-6F);
    CHECK((mirrored - Vec2(p.y(), p.x())).norm() < 1e-6F);
  }
}

TEST_CASE("four lanes give the bits of one") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 1000; ++i) {
    Float4 u;
    Float4 v;
    for (int k = 0; k < 4; ++k) {
      u[k] = uniform(generator);
      v[k] = uniform(generator);
    }
    Float4 x;
    Float4 y;
    Float4 z;
    square_to_sphere(u, v, x, y, z);
    Float4 back_u;
    Float4 back_v;
    sphere_to_square(x, y, z, back_u, back_v);
    for (int k = 0; k < 4; ++k) {
      const Vec3 w = square_to_sphere(Vec2(u[k], v[k]));
      const Vec2 p = sphere_to_square(w);
      CHECK((w.x() == x[k] && w.y() == y[k] && w.z() == z[k]));
      CHECK((p.x() == back_u[k] && p.y() == back_v[k]));
    }
  }
}
