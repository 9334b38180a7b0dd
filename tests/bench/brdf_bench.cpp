// Times of the BRDF library's inner loops, one thread: brdf_bench [FILE.binary]

#include "timing.h"

#include <brdf/brdf_maps.h>
#include <brdf/brdf_properties.h>
#include <brdf/tabulate.h>

#include <wavelet/square/sphere_map.h>

#include <string>

using namespace haarlight;
using namespace haarlight::brdf;
using bench::report;

namespace {

/// A direction of the upper hemisphere; neighbouring i are neighbours if `coherent`.
Vec3 direction(int i, double step) {
  const double a = i * 0.7548776662466927 * step;
  const double b = i * 0.5698402909980532 * step;
  const auto u = static_cast<float>(a - static_cast<int>(a));
  const auto v = static_cast<float>(b - static_cast<int>(b));
  Vec3 w = wavelet::square_to_sphere(Vec2(u, v));
  w.z() = std::abs(w.z());
  return w;
}

std::vector<DirectionBatch> batches(int count, double step) {
  std::vector<DirectionBatch> result(static_cast<std::size_t>(count / batch_capacity));
  int i = 0;
  for (DirectionBatch& batch : result) {
    batch.count = batch_capacity;
    for (int k = 0; k < batch_capacity; ++k, ++i) {
      const Vec3 wi = direction(i, step);
      const Vec3 wo = direction(3 * i + 1, 0.37 * step);
      for (int axis = 0; axis < 3; ++axis) {
        batch.wi[axis][k] = wi[axis];
        batch.wo[axis][k] = wo[axis];
      }
    }
  }
  return result;
}

double sum_of(const MeasuredBrdf& brdf, const std::vector<DirectionBatch>& pairs) {
  Float4 sum{};
  for (const DirectionBatch& batch : pairs) {
    Float4 values[batch_capacity];
    brdf.evaluate(batch, values);
    for (const Float4& value : values)
      sum += value;
  }
  return static_cast<double>(sum[0]);
}

double sum_one_by_one(const MeasuredBrdf& brdf, const std::vector<DirectionBatch>& pairs) {
  Rgb sum = Rgb::Zero();
  for (const DirectionBatch& b : pairs)
    for (int i = 0; i < b.count; ++i)
      sum +=
          brdf.evaluate({b.wi[0][i], b.wi[1][i], b.wi[2][i]}, {b.wo[0][i], b.wo[1][i], b.wo[2][i]});
  return static_cast<double>(sum[0]);
}

void time_look_ups(const MeasuredBrdf& brdf) {
  constexpr int count = 2'000'000;
  const auto random = batches(count, 1);
  const auto coherent = batches(count, 1e-4);
  report("evaluate, batches, neighbouring directions", count,
         [&] { return sum_of(brdf, coherent); });
  report("evaluate, batches, random directions", count, [&] { return sum_of(brdf, random); });
  report("evaluate, one by one, neighbouring", count,
         [&] { return sum_one_by_one(brdf, coherent); });
  report("evaluate, one by one, random", count, [&] { return sum_one_by_one(brdf, random); });
}

/// One map in eight of the default set of a size; "each" is per pixel and sample of the default
/// grid.
void time_maps(const MeasuredBrdf& brdf, int size) {
  BrdfMapOptions options;
  options.size = size;
  const BrdfMaps maps(brdf, options);
  const std::string what =
      "maps of " + std::to_string(size) + " x " + std::to_string(size) + ", 8 of 64";
  report(what.c_str(), 8.0 * 4 * size * size, [&] {
    double sum = 0;
    for (int column = 3; column < 64; column += 8)
      sum += wavelet::map_mean(maps.make(column, 0))[1];
    return sum;
  });
}

MeasuredBrdf table(int argc, char** argv) {
  if (argc > 1)
    return MeasuredBrdf(std::string(argv[1]));
  return MeasuredBrdf(tabulate(Ggx{Rgb::Constant(0.1F), Rgb::Constant(0.5F), 0.1}));
}

} // namespace

int main(int argc, char** argv) {
  const MeasuredBrdf brdf = table(argc, argv);
  time_look_ups(brdf);
  for (const int size : {64, 128, 512})
    time_maps(brdf, size);
  report("directional albedo", 1,
         [&] { return static_cast<double>(luminance(directional_albedo(brdf, 0.5, 0.5))); });
}
