// Products and their sampling. Rivals in the same run: the dense way, multiplying two 512² maps and
// building the mip pyramid that a descent needs, and sampling such a pyramid.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/product/synchronous_product.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

constexpr int map_size = 512;
constexpr int theta_cells = 8;

/// Lobes about the mirror direction over a dim ground, cut by the horizon.
Map lobe_map(int column, float sharpness) {
  Map map(map_size);
  const float theta = (static_cast<float>(column) + 0.5F) * 0.5F * pi / theta_cells;
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      const Vec3 w = square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) / map_size,
                                           (static_cast<float>(y) + 0.5F) / map_size));
      const float cosine = std::max(0.0F, std::sin(theta) * w.x() + std::cos(theta) * w.z());
      const float lobe = sharpness * std::exp(sharpness * (w.z() - 1));
      map.set(x, y, (Rgb(0.3F, 0.4F, 0.5F) * lobe + Rgb(0.02F, 0.02F, 0.03F)) * cosine);
    }
  return map;
}

/// A dim gradient with a few dozen lamps.
Map light_map(int size, unsigned seed = 5) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Map map(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      map.set(x, y,
              Rgb(0.2F, 0.3F, 0.4F) * (1.1F + std::sin(0.02F * static_cast<float>(x + 2 * y))));
  for (int i = 0; i < 40; ++i) {
    const int cx = static_cast<int>(uniform(generator) * static_cast<float>(size - 8));
    const int cy = static_cast<int>(uniform(generator) * static_cast<float>(size - 8));
    const float power = 300 * uniform(generator);
    for (int y = cy; y < cy + 6; ++y)
      for (int x = cx; x < cx + 6; ++x)
        map.set(x, y, Rgb(power, 0.9F * power, 0.7F * power));
  }
  return map;
}

Tree tree_of(const Map& map, double tolerance) {
  CompressOptions options;
  options.threshold.tolerance = tolerance;
  CompressReport report;
  return compress_map(map, options, report);
}

const Tree& light_tree() {
  static const Tree tree = tree_of(light_map(1024), 1e-4);
  return tree;
}

/// The θ_r-only set of one sharpness.
struct Lobes {
  std::vector<Tree> trees;
  std::vector<TreeView> views;
  explicit Lobes(float sharpness) {
    for (int c = 0; c < theta_cells; ++c)
      trees.push_back(tree_of(lobe_map(c, sharpness), 5e-4));
    for (const Tree& tree : trees)
      views.push_back(tree.view());
  }
};

const Pyramid& pyramid(int sharpness) {
  static const Pyramid wide(Lobes(10).views);
  static const Pyramid glossy(Lobes(300).views);
  static const Pyramid mirror(Lobes(5000).views);
  return sharpness < 100 ? wide : sharpness < 1000 ? glossy : mirror;
}

RotatedReflectance reflectance_at(const Pyramid& lobes, const Vec3& n, const Vec3& wo) {
  RotatedReflectance r;
  r.pyramid = &lobes;
  r.reflection = reflection_frame(n, wo);
  const float c = std::clamp(std::acos(r.reflection.cos_theta_r) * (2 / pi) * theta_cells - 0.5F,
                             0.0F, theta_cells - 1.001F);
  r.theta_index0 = static_cast<int>(c);
  r.theta_index1 = r.theta_index0 + 1;
  r.blend = c - static_cast<float>(r.theta_index0);
  return r;
}

RotatedReflectance reflectance_anywhere(const Pyramid& lobes, std::mt19937& generator) {
  std::normal_distribution<float> gauss;
  Vec3 n(gauss(generator), gauss(generator), gauss(generator));
  Vec3 wo(gauss(generator), gauss(generator), gauss(generator));
  n.normalize();
  wo.normalize();
  if (n.dot(wo) < 0)
    wo = -wo;
  return reflectance_at(lobes, n, wo);
}

void draw_points(std::mt19937& generator, std::span<Vec2> points) {
  for (Vec2& p : points)
    p = Vec2(static_cast<float>(generator() >> 8U), static_cast<float>(generator() >> 8U)) *
        0x1p-24F;
}

void adaptive_product(benchmark::State& state) {
  AdaptiveProduct product(light_tree().view());
  const Pyramid& lobes = pyramid(static_cast<int>(state.range(0)));
  std::mt19937 generator(1);
  std::size_t leaves = 0;
  for (auto _ : state)
    leaves += product.build(reflectance_anywhere(lobes, generator), {}).leaf_count();
  state.counters["leaves"] =
      benchmark::Counter(static_cast<double>(leaves), benchmark::Counter::kAvgIterations);
  state.counters["time/leaf"] = benchmark::Counter(
      static_cast<double>(leaves), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(adaptive_product)->Arg(10)->Arg(300)->Arg(5000);

/// The points of a row of pixels on a round object: the normal turns by 1/256 from one to the next.
void following_product(benchmark::State& state) {
  AdaptiveProduct product(light_tree().view());
  const Pyramid& lobes = pyramid(static_cast<int>(state.range(0)));
  std::size_t leaves = 0;
  float turn = 0;
  for (auto _ : state) {
    turn = turn > 1.4F ? -1.4F : turn + 1.0F / 256;
    const Vec3 n(std::sin(turn), 0, std::cos(turn));
    leaves += product.build_or_reuse(reflectance_at(lobes, n, Vec3::UnitZ()), {}).leaf_count();
  }
  state.counters["leaves"] =
      benchmark::Counter(static_cast<double>(leaves), benchmark::Counter::kAvgIterations);
  state.counters["time/leaf"] = benchmark::Counter(
      static_cast<double>(leaves), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(following_product)->Arg(10)->Arg(300)->Arg(5000);

void sample_64_of_product(benchmark::State& state) {
  AdaptiveProduct product(light_tree().view());
  std::mt19937 generator(1);
  const ProductTree& tree =
      product.build(reflectance_anywhere(pyramid(static_cast<int>(state.range(0))), generator), {});
  std::vector<Vec2> points(64);
  std::vector<Descent> descents(64);
  for (auto _ : state) {
    draw_points(generator, points);
    tree.sample(points, descents);
    benchmark::DoNotOptimize(descents.data());
  }
}
BENCHMARK(sample_64_of_product)->Arg(10)->Arg(300)->Arg(5000);

/// Luminance of the product of two maps and all its coarser averages.
struct DenseProduct {
  std::vector<std::vector<float>> levels;

  void build(const Map& a, const Map& b) {
    levels.resize(10);
    levels[9].resize(std::size_t{map_size} * map_size);
    for (std::size_t i = 0; i < levels[9].size(); ++i)
      levels[9][i] = luminance_weights[0] * a.rgb[3 * i] * b.rgb[3 * i] +
                     luminance_weights[1] * a.rgb[3 * i + 1] * b.rgb[3 * i + 1] +
                     luminance_weights[2] * a.rgb[3 * i + 2] * b.rgb[3 * i + 2];
    for (std::size_t l = 9; l > 0; --l)
      halve(levels[l], levels[l - 1], std::size_t{1} << (l - 1));
  }

  static void halve(const std::vector<float>& fine, std::vector<float>& coarse, std::size_t side) {
    coarse.resize(side * side);
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x) {
        const float* p = fine.data() + 4 * side * y + 2 * x;
        coarse[side * y + x] = 0.25F * (p[0] + p[1] + p[2 * side] + p[2 * side + 1]);
      }
  }

  Descent sample(float u1, float u2) const {
    Descent d;
    d.u1 = u1;
    d.u2 = u2;
    std::size_t x = 0;
    std::size_t y = 0;
    for (std::size_t l = 1; l < levels.size(); ++l) {
      const float* p = levels[l].data() + ((2 * y) << l) + 2 * x;
      const std::size_t side = std::size_t{1} << l;
      const unsigned q = steer(d, Float4{p[0], p[1], p[side], p[side + 1]});
      x = 2 * x + (q & 1U);
      y = 2 * y + (q >> 1U);
    }
    return d;
  }
};

void dense_product(benchmark::State& state) {
  const Map light = light_map(map_size);
  const Map lobe = lobe_map(2, static_cast<float>(state.range(0)));
  DenseProduct product;
  for (auto _ : state) {
    product.build(light, lobe);
    benchmark::DoNotOptimize(product.levels[0][0]);
  }
}
BENCHMARK(dense_product)->Arg(300);

void synchronous_product(benchmark::State& state) {
  const Tree light = tree_of(light_map(map_size), 5e-4);
  const Tree lobe = tree_of(lobe_map(2, static_cast<float>(state.range(0))), 5e-4);
  const TreeFactor factors[2] = {TreeFactor(light.view()), TreeFactor(lobe.view())};
  SynchronousProduct product;
  for (auto _ : state)
    benchmark::DoNotOptimize(product.build(factors).nodes().data());
}
BENCHMARK(synchronous_product)->Arg(10)->Arg(300)->Arg(5000);

/// The same walk over n trees, by squares that have detail in at least two of them.
void product_of_n_trees(benchmark::State& state) {
  const auto n = static_cast<unsigned>(state.range(0));
  std::vector<Tree> trees;
  for (unsigned i = 0; i < n; ++i)
    trees.push_back(tree_of(light_map(map_size, 5 + i), 5e-4));
  std::vector<TreeFactor> factors;
  for (const Tree& tree : trees)
    factors.emplace_back(tree.view());
  SynchronousProduct product;
  std::size_t squares = 0;
  for (auto _ : state)
    squares += product.build(factors).nodes().size();
  state.counters["squares"] =
      benchmark::Counter(static_cast<double>(squares), benchmark::Counter::kAvgIterations);
  state.counters["time/square"] = benchmark::Counter(
      static_cast<double>(squares), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(product_of_n_trees)->Arg(2)->Arg(3)->Arg(5);

void sample_64_of_dense(benchmark::State& state) {
  DenseProduct product;
  product.build(light_map(map_size), lobe_map(2, 300));
  std::mt19937 generator(1);
  std::vector<Vec2> points(64);
  for (auto _ : state) {
    draw_points(generator, points);
    for (const Vec2& p : points)
      benchmark::DoNotOptimize(product.sample(p.x(), p.y()));
  }
}
BENCHMARK(sample_64_of_dense);

} // namespace

BENCHMARK_MAIN();
