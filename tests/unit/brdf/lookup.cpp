#include "brdf_test_support.h"

#include <brdf/brdf_properties.h>
#include <brdf/measured_brdf.h>

#include <numbers>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;
using Eigen::Vector3d;

namespace {

constexpr double pi_d = std::numbers::pi;

/// Half and difference angles in double by the textbook: rotate ω_i so that h becomes the pole.
struct Reference {
  double theta_h, theta_d, phi_d;

  Reference(const Vec3& wi_in, const Vec3& wo_in) {
    const Vector3d wi = wi_in.cast<double>().normalized();
    const Vector3d wo = wo_in.cast<double>().normalized();
    const Vector3d h = (wi + wo).normalized();
    theta_h = std::atan2(std::hypot(h.x(), h.y()), h.z());
    const double phi_h = std::atan2(h.y(), h.x());
    const Vector3d d = Eigen::AngleAxisd(-theta_h, Vector3d::UnitY()) *
                       (Eigen::AngleAxisd(-phi_h, Vector3d::UnitZ()) * wi);
    theta_d = std::atan2(std::hypot(d.x(), d.y()), d.z());
    phi_d = std::atan2(d.y(), d.x());
  }
  double h() const { return 90 * std::sqrt(theta_h / (pi_d / 2)); }
  double d() const { return 90 * theta_d / (pi_d / 2); }
  double p() const { return 180 * (phi_d < 0 ? phi_d + pi_d : phi_d) / pi_d; }
};

bool next_to_edge(double coordinate) {
  return std::abs(coordinate - std::round(coordinate)) < 2e-4;
}

/// Trilinear interpolation over valid cells, cell by cell, from the raw file values.
Rgb reference_trilinear(const MerlTable& table, const Reference& at) {
  const double h = std::clamp(at.h() - 0.5, 0.0, 89.0);
  const double d = std::clamp(at.d() - 0.5, 0.0, 89.0);
  const double p = at.p() - 0.5;
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double weights = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int ih = static_cast<int>(std::floor(h)) + (corner & 1);
    const int id = static_cast<int>(std::floor(d)) + ((corner >> 1) & 1);
    const int ip = static_cast<int>(std::floor(p)) + (corner >> 2);
    const double weight = (1 - std::abs(h - ih)) * (1 - std::abs(d - id)) * (1 - std::abs(p - ip));
    const std::size_t cell = table.cell(std::min(ih, 89), std::min(id, 89), (ip + 180) % 180);
    if (table.value(0, cell) < 0)
      continue;
    weights += weight;
    for (int c = 0; c < 3; ++c)
      sum[c] += weight * table.value(c, cell) * merl_scale[c];
  }
  return weights > 0 ? Rgb((sum / weights).cast<float>()) : Rgb::Zero();
}

bool same_bits(const Float4& a, const Rgb& b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

DirectionBatch random_batch(std::mt19937& generator, int count) {
  DirectionBatch batch;
  batch.count = count;
  for (int i = 0; i < count; ++i) {
    const Vec3 wi = random_direction(generator);
    const Vec3 wo = random_direction(generator);
    for (int axis = 0; axis < 3; ++axis) {
      batch.wi[axis][i] = wi[axis];
      batch.wo[axis][i] = i % 9 == 4 && axis == 2 ? -wo[axis] : wo[axis];
    }
  }
  return batch;
}

} // namespace

TEST_CASE("nearest look-up reads the bins of the measurements' own reader", "[lookup]") {
  const MerlTable table = random_table(2);
  const MeasuredBrdf brdf(table, Lookup::Nearest);
  std::mt19937 generator(3);
  int compared = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 wi = random_direction(generator);
    const Vec3 wo = random_direction(generator);
    const Reference at(wi, wo);
    if (next_to_edge(at.h()) || next_to_edge(at.d()) || next_to_edge(at.p()))
      continue;
    const std::size_t cell = table.cell(static_cast<int>(at.h()), static_cast<int>(at.d()),
                                        std::min(static_cast<int>(at.p()), 179));
    const Rgb value = brdf.evaluate(wi, wo);
    for (int c = 0; c < 3; ++c)
      REQUIRE(value[c] == static_cast<float>(table.value(c, cell) * merl_scale[c]));
    ++compared;
  }
  CHECK(compared > 19000);
}

TEST_CASE("trilinear look-up agrees with a plain one over valid cells", "[lookup]") {
  for (const int hole : {0, 3}) {
    const MerlTable table = random_table(4, hole);
    const MeasuredBrdf brdf(table);
    std::mt19937 generator(5);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 wi = random_direction(generator);
      const Vec3 wo = random_direction(generator);
      const Reference at(wi, wo);
      if (at.theta_h < 0.01 || at.theta_d < 0.01)
        continue;
      const Rgb expected = reference_trilinear(table, at);
      const Rgb value = brdf.evaluate(wi, wo);
      for (int c = 0; c < 3; ++c)
        REQUIRE(value[c] == Approx(expected[c]).epsilon(hole == 0 ? 3e-4 : 3e-3));
    }
  }
}

TEST_CASE("half angles keep their precision next to the mirror direction", "[lookup]") {
  std::mt19937 generator(6);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 wo = random_direction(generator);
    const Vec3 tilt = 1e-3F * random_direction(generator);
    const Vec3 wi = (Vec3(-wo.x(), -wo.y(), wo.z()) + tilt).normalized();
    if (wi.z() < 0.02F)
      continue;
    const float a[3] = {wi.x(), wi.y(), wi.z()};
    const float b[3] = {wo.x(), wo.y(), wo.z()};
    const TablePosition<float> place = table_position_of_one(half_difference(a, b), true);
    const Reference at(wi, wo);
    REQUIRE(static_cast<double>(place.theta_h) == Approx(at.h()).epsilon(2e-3).margin(2e-3));
    REQUIRE(static_cast<double>(place.theta_d) == Approx(at.d()).margin(1e-3));
  }
}

TEST_CASE("values at bin centres are the cells themselves", "[lookup]") {
  const MerlTable table = random_table(7);
  const MeasuredBrdf brdf(table);
  for (const int cell : {0, 1, 44, 88, 89}) {
    const auto k = static_cast<float>(cell);
    const Float4 value = brdf.at({k + 0.5F, k + 0.5F, 2 * k + 0.5F});
    CHECK(value[1] == Approx(brdf.cell(cell, cell, 2 * cell)[1]));
  }
  // φ_d wraps: half way between the last and the first bin.
  const Float4 seam = brdf.at({10.5F, 20.5F, 180.0F});
  CHECK(seam[0] == Approx(0.5 * (brdf.cell(10, 20, 179)[0] + brdf.cell(10, 20, 0)[0])));
  CHECK(brdf.at({10.5F, 20.5F, 0.0F})[0] == seam[0]);
}

TEST_CASE("invalid cells darken nothing, and where none is valid the value is 0", "[lookup]") {
  MerlTable table = constant_table(0.25);
  for (std::size_t c = 0; c < 3; ++c)
    for (int p = 0; p < 180; ++p)
      table.raw[c * table.plane_size() + table.cell(40, 30, p)] = -1;
  const MeasuredBrdf brdf(table);
  CHECK(brdf.at({40.9F, 30.5F, 3.2F})[0] == Approx(0.25));
  CHECK(brdf.at({40.5F, 30.5F, 3.2F})[0] == 0);
  CHECK(brdf.at({40.5F, 30.5F, 3.2F})[3] == 0);
}

TEST_CASE("look-up is reciprocal to the bit, and 0 below the horizon", "[lookup]") {
  const MeasuredBrdf brdf(random_table(8, 5));
  std::mt19937 generator(9);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 wi = random_direction(generator);
    const Vec3 wo = random_direction(generator);
    REQUIRE((brdf.evaluate(wi, wo) == brdf.evaluate(wo, wi)).all());
    REQUIRE((brdf.evaluate(wi, -wo) == 0.0F).all());
    REQUIRE((brdf.evaluate(Vec3(wi.x(), wi.y(), -wi.z()), wo) == 0.0F).all());
  }
  CHECK((brdf.evaluate(Vec3::UnitZ(), Vec3::UnitX()) == 0.0F).all());
  CHECK((brdf.evaluate(Vec3::UnitZ(), Vec3::UnitZ()) >= 0.0F).all());
}

TEST_CASE("one look-up and many give the same bits", "[lookup]") {
  for (const Lookup lookup : {Lookup::Trilinear, Lookup::Nearest}) {
    for (const int bins : {180, 360}) {
      const MeasuredBrdf brdf(random_table(10, 4, bins), lookup);
      std::mt19937 generator(11);
      for (const int count : {1, 5, 16, 37, 64}) {
        const DirectionBatch batch = random_batch(generator, count);
        Float4 values[batch_capacity];
        brdf.evaluate(batch, values);
        for (int i = 0; i < count; ++i)
          REQUIRE(same_bits(values[i],
                            brdf.evaluate({batch.wi[0][i], batch.wi[1][i], batch.wi[2][i]},
                                          {batch.wo[0][i], batch.wo[1][i], batch.wo[2][i]})));
      }
    }
  }
}

TEST_CASE("a table without the reciprocity fold distinguishes the two directions", "[lookup]") {
  MerlTable table(360);
  for (std::size_t i = 0; i < table.raw.size(); ++i)
    table.raw[i] = i % 360 < 180 ? 100 : 200;
  const MeasuredBrdf brdf(table);
  std::mt19937 generator(12);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 wi = random_direction(generator);
    const Vec3 wo = random_direction(generator);
    const double phi = Reference(wi, wo).phi_d * 180 / pi_d;
    if (std::abs(std::sin(Reference(wi, wo).phi_d)) < 0.02)
      continue;
    REQUIRE(brdf.evaluate(wi, wo)[0] * 1500 == Approx(phi > 0 ? 100 : 200).epsilon(1e-5));
    REQUIRE(brdf.evaluate(wo, wi)[0] * 1500 == Approx(phi > 0 ? 200 : 100).epsilon(1e-5));
  }
}

TEST_CASE("bilateral asymmetry is measured and can be averaged away", "[lookup]") {
  CHECK(bilateral_asymmetry(MeasuredBrdf(constant_table(0.3))) == 0);
  MerlTable table = constant_table(1);
  for (std::size_t i = 0; i < table.raw.size(); ++i)
    table.raw[i] *= i % 180 < 90 ? 1.1 : 0.9; // |f(φ) − f(π − φ)| = 0.2 of mean 1
  const MeasuredBrdf brdf(table);
  CHECK(bilateral_asymmetry(brdf) == Approx(0.2).epsilon(1e-5));
  const MeasuredBrdf averaged = brdf.symmetrised();
  CHECK(bilateral_asymmetry(averaged) == 0);
  CHECK(averaged.cell(3, 4, 5)[0] == Approx(1));
  const MeasuredBrdf holed = MeasuredBrdf(random_table(13, 3)).symmetrised();
  CHECK(bilateral_asymmetry(holed) == 0);
}

TEST_CASE("provenance distinguishes tables", "[lookup]") {
  const MeasuredBrdf one(random_table(1));
  CHECK(one.hash() == MeasuredBrdf(random_table(1)).hash());
  CHECK(one.hash() != MeasuredBrdf(random_table(2)).hash());
  CHECK(one.hash().size() == 16);
}
