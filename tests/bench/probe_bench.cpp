// Times of the probe library's inner loops, one thread: probe_bench [PROBE]

#include "timing.h"

#include <probe/light_distribution.h>
#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <probe/synth.h>

#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <cstdio>
#include <ctime>

using namespace haarlight;
using namespace haarlight::probe;
using bench::report;
using bench::seconds_since;

namespace {

/// Points that fill the square evenly.
Vec2 spread_point(int i) {
  const double a = i * 0.7548776662466927;
  const double b = i * 0.5698402909980532;
  return {static_cast<float>(a - static_cast<int>(a)), static_cast<float>(b - static_cast<int>(b))};
}

void time_look_ups(const Probe& probe) {
  constexpr int count = 4'000'000;
  std::vector<Vec3> directions;
  directions.reserve(count);
  for (int i = 0; i < count; ++i)
    directions.push_back(wavelet::square_to_sphere(spread_point(i)));
  report("radiance", count, [&] {
    double sum = 0;
    for (const Vec3& w : directions)
      sum += probe.radiance(w)[1];
    return sum;
  });
}

void time_sampling(const Probe& probe) {
  constexpr int count = 4'000'000;
  const auto start = std::clock();
  const LightDistribution light(probe);
  std::printf("%-44s %9.3f ms\n", "LightDistribution made", 1e3 * seconds_since(start));
  std::vector<Vec2> points;
  points.reserve(count);
  for (int i = 0; i < count; ++i)
    points.push_back(spread_point(i));
  report("sample", count, [&] {
    double sum = 0;
    for (const Vec2& point : points)
      sum += light.sample(point).pdf;
    return sum;
  });
  report("pdf", count, [&] {
    double sum = 0;
    for (const Vec2& point : points)
      sum += light.pdf(wavelet::square_to_sphere(point));
    return sum;
  });
}

void time_maps(const Probe& probe) {
  const int size = default_map_size(probe, 1);
  report("world map, each pixel", static_cast<double>(size) * size,
         [&] { return wavelet::map_mean(world_map(probe, size, 4))[1]; });
  const ProbeMaps maps(probe, {128, 64, 4});
  report("rotated maps 128² of 64² cells, each tap", 16.0 * 128 * 128 * 16, [&] {
    double sum = 0;
    for (int i = 0; i < 16; ++i)
      sum += wavelet::map_mean(maps.make(4 * i, 3 * i))[1];
    return sum / 16;
  });
}

Probe probe_to_time(int argc, char** argv, Lookup lookup) {
  if (argc > 1)
    return read_probe(argv[1], std::nullopt, lookup).probe;
  return {draw_angular(*make_scene(SceneKind::SunSky), 1024), Mapping::Angular, lookup};
}

} // namespace

int main(int argc, char** argv) {
  const ThreadLimit one(1);
  const Probe probe = probe_to_time(argc, argv, Lookup::Nearest);
  report("integral, each pixel", static_cast<double>(probe.width()) * probe.height(),
         [&] { return probe.integral()[1]; });
  time_look_ups(probe);
  time_look_ups(probe_to_time(argc, argv, Lookup::Bilinear));
  time_sampling(probe);
  time_maps(probe);
  return 0;
}
