// The published product on hash tables (<wavelet/reference/reference.h>), beside two rivals in the
// same run: the synchronous product that the toolkit uses, and the dense way, multiplying RGB
// images pixel by pixel and averaging all the way up, in loops that the compiler vectorises. All
// three multiply the same two trees, all three channels, and must agree on the integral. Images and
// coefficient sets are made beforehand.
//
// Usage: reference_bench [options of Google Benchmark] [BRDF.haar LIGHT.haar]
// The files may also be named by HAARLIGHT_BENCH_BRDF and HAARLIGHT_BENCH_LIGHT; without any the
// trees are synthetic. Ends with each way's time relative to the dense one's, best of all
// repetitions: ask for --benchmark_repetitions=N --benchmark_enable_random_interleaving=true.

#include "reference_basis.h"

#include <wavelet/file/tree_set.h>
#include <wavelet/product/synchronous_product.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <benchmark/benchmark.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <unordered_set>

using namespace haarlight;
using namespace haarlight::wavelet;
using namespace haarlight::wavelet::reference;

namespace {

struct Paths {
  std::string brdf;
  std::string light;
};
Paths paths;

// --- The two factors ---

/// A glossy lobe about the mirror direction over a dim ground, cut by the horizon.
Map synthetic_brdf(int size) {
  const float theta = 0.4F;
  Map map(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto side = static_cast<float>(size);
      const Vec3 w = square_to_sphere(
          Vec2((static_cast<float>(x) + 0.5F) / side, (static_cast<float>(y) + 0.5F) / side));
      const float cosine = std::max(0.0F, std::sin(theta) * w.x() + std::cos(theta) * w.z());
      const float lobe = 100 * std::exp(100 * (w.z() - 1));
      map.set(x, y, (Rgb(0.3F, 0.4F, 0.5F) * lobe + Rgb(0.02F, 0.02F, 0.03F)) * cosine);
    }
  return map;
}

/// A gradient with noise and a few dozen lamps.
Map synthetic_light(int size) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  Map map(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const float wave = std::sin(6 * static_cast<float>(x + 2 * y) / static_cast<float>(size));
      map.set(x, y, Rgb(0.2F, 0.3F, 0.4F) * (1.1F + wave + 0.2F * uniform(generator)));
    }
  for (int i = 0; i < 40; ++i) {
    const int x0 = static_cast<int>(uniform(generator) * static_cast<float>(size - 4));
    const int y0 = static_cast<int>(uniform(generator) * static_cast<float>(size - 4));
    const float power = 300 * uniform(generator);
    for (int y = y0; y < y0 + 3; ++y)
      for (int x = x0; x < x0 + 3; ++x)
        map.set(x, y, Rgb(power, 0.9F * power, 0.7F * power));
  }
  return map;
}

/// A stored map at a size: a set's one map, or of a BRDF's that at a quarter of all θ_r.
Map stored_map(const std::string& path, int size) {
  const TreeSet set(path);
  const int level = std::countr_zero(static_cast<unsigned>(size));
  return set.tree(set.info().columns / 4, 0).reconstruct(level);
}

Tree tree_of(const Map& map, double tolerance) {
  CompressOptions options;
  options.threshold.tolerance = tolerance;
  CompressReport report;
  return compress_map(map, options, report);
}

using Plane = std::vector<float>;

/// One factor in the form that each rival takes.
struct Factor {
  Tree tree;
  CoefficientSet<float> sets[3];
  Plane planes[3];

  Factor(const Map& map, double tolerance) : tree(tree_of(map, tolerance)) {
    const TreeView view = tree.view();
    const Map image = view.reconstruct(view.levels);
    for (std::size_t c = 0; c < 3; ++c) {
      sets[c] = coefficient_set<float>(view, static_cast<Channel>(c));
      for (std::size_t i = c; i < image.rgb.size(); i += 3)
        planes[c].push_back(image.rgb[i]);
    }
  }
};

/// Quadrants of the squares of a tree, and the root: where averages step.
void add_quadrants(const TreeView& tree, std::uint32_t node, const Square& s,
                   std::unordered_set<Square, SquareHash>& squares) {
  squares.insert(s);
  if (node == no_node)
    return;
  for (unsigned q = 0; q < 4; ++q)
    add_quadrants(tree, tree.child(node, q), s.quadrant(q), squares);
}

struct Factors {
  Factor brdf;
  Factor light;
  std::vector<Square> brdf_squares; ///< of which the synchronous product finds the averages
  std::vector<Square> all_squares;  ///< whose averages may differ from their parent's

  explicit Factors(int size)
      : brdf(paths.brdf.empty() ? synthetic_brdf(size) : stored_map(paths.brdf, size), 5e-4),
        light(paths.light.empty() ? synthetic_light(size) : stored_map(paths.light, size), 1e-4) {
    std::unordered_set<Square, SquareHash> squares;
    add_quadrants(brdf.tree.view(), brdf.tree.view().root(), {}, squares);
    brdf_squares.assign(squares.begin(), squares.end());
    add_quadrants(light.tree.view(), light.tree.view().root(), {}, squares);
    all_squares.assign(squares.begin(), squares.end());
  }
};

const Factors& factors_of(std::int64_t size) {
  static std::map<std::int64_t, std::unique_ptr<Factors>> made;
  auto& factors = made[size];
  if (!factors)
    factors = std::make_unique<Factors>(static_cast<int>(size));
  return *factors;
}

// --- The dense way ---

void multiply_row(const float* __restrict a, const float* __restrict b, float* __restrict product,
                  std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    product[i] = a[i] * b[i];
}

/// Averages of 2 × 2 pixels of two rows.
void halve_rows(const float* __restrict upper, const float* __restrict lower,
                float* __restrict coarse, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    coarse[i] = 0.25F * ((upper[2 * i] + upper[2 * i + 1]) + (lower[2 * i] + lower[2 * i + 1]));
}

/// The product of two images and its averages over all squares; one channel.
class DensePyramid {
public:
  explicit DensePyramid(int size) {
    for (auto side = static_cast<std::size_t>(size); side > 0; side /= 2)
      m_levels.emplace_back(side * side);
    m_size = static_cast<std::size_t>(size);
  }

  /// The first average is taken while the rows that it is of are near.
  void build(const Plane& a, const Plane& b) {
    const std::size_t n = m_size;
    Plane& product = m_levels[0];
    for (std::size_t y = 0; y < n; y += 2) {
      multiply_row(a.data() + y * n, b.data() + y * n, product.data() + y * n, 2 * n);
      halve_rows(product.data() + y * n, product.data() + (y + 1) * n,
                 m_levels[1].data() + y / 2 * (n / 2), n / 2);
    }
    for (std::size_t l = 2; l < m_levels.size(); ++l) {
      const std::size_t side = n >> l;
      for (std::size_t y = 0; y < side; ++y)
        halve_rows(m_levels[l - 1].data() + 4 * y * side,
                   m_levels[l - 1].data() + (4 * y + 2) * side, m_levels[l].data() + y * side,
                   side);
    }
  }

  float integral() const { return m_levels.back()[0]; }

private:
  std::size_t m_size = 0;
  std::vector<Plane> m_levels; ///< finest first
};

// --- The rivals: each returns ∫∫ of the product ---

struct DenseProduct {
  const Factors& factors;
  DensePyramid pyramids[3];

  explicit DenseProduct(const Factors& f)
      : factors(f), pyramids{size_of(f), size_of(f), size_of(f)} {}
  static DensePyramid size_of(const Factors& f) { return DensePyramid(1 << f.brdf.tree.levels); }

  Rgb operator()() {
    Rgb result;
    for (std::size_t c = 0; c < 3; ++c) {
      pyramids[c].build(factors.brdf.planes[c], factors.light.planes[c]);
      result[static_cast<int>(c)] = pyramids[c].integral();
    }
    return result;
  }
};

struct SynchronousRun {
  std::array<TreeFactor, 2> factors;
  SynchronousProduct product = {};
  explicit SynchronousRun(const Factors& f)
      : factors{TreeFactor(f.light.tree.view()), TreeFactor(f.brdf.tree.view())} {}

  Rgb operator()() { return product.build(factors).integral(); }
};

/// PRODUCT: all coefficients.
struct HashProduct {
  const Factors& factors;
  Rgb operator()() const {
    Rgb result;
    for (std::size_t c = 0; c < 3; ++c)
      result[static_cast<int>(c)] = multiply(factors.light.sets[c], factors.brdf.sets[c]).root;
    return result;
  }
};

/// OPPRODUCT at given squares, CsumHash included.
struct HashAverages {
  const Factors& factors;
  const std::vector<Square>& squares;
  Rgb operator()() const {
    Rgb result;
    for (std::size_t c = 0; c < 3; ++c) {
      Product<float> product(factors.light.sets[c], factors.brdf.sets[c]);
      for (const Square& s : squares)
        benchmark::DoNotOptimize(product.average(s));
      result[static_cast<int>(c)] = product.root();
    }
    return result;
  }
};

template <class Run>
void time_run(benchmark::State& state, Run run) {
  const Rgb expected = DenseProduct(factors_of(state.range(0)))();
  if (((run() - expected).abs() > 1e-3F * expected.abs()).any())
    state.SkipWithError("the integral is not the dense one");
  for (auto _ : state)
    benchmark::DoNotOptimize(run());
}

void dense(benchmark::State& state) { time_run(state, DenseProduct(factors_of(state.range(0)))); }

void synchronous_product(benchmark::State& state) {
  const Factors& factors = factors_of(state.range(0));
  time_run(state, SynchronousRun(factors));
  state.counters["brdf nodes"] = static_cast<double>(factors.brdf.tree.links.size());
  state.counters["light nodes"] = static_cast<double>(factors.light.tree.links.size());
}

void hash_product(benchmark::State& state) {
  time_run(state, HashProduct{factors_of(state.range(0))});
}

void hash_opproduct_same_squares(benchmark::State& state) {
  const Factors& factors = factors_of(state.range(0));
  time_run(state, HashAverages{factors, factors.brdf_squares});
  state.counters["squares"] = static_cast<double>(factors.brdf_squares.size());
}

void hash_opproduct_all_squares(benchmark::State& state) {
  const Factors& factors = factors_of(state.range(0));
  time_run(state, HashAverages{factors, factors.all_squares});
  state.counters["squares"] = static_cast<double>(factors.all_squares.size());
}

BENCHMARK(dense)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);
BENCHMARK(synchronous_product)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);
BENCHMARK(hash_product)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);
BENCHMARK(hash_opproduct_same_squares)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);
BENCHMARK(hash_opproduct_all_squares)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);

/// Adds a table of ratios at the end, of the best CPU times.
class RatioReporter : public benchmark::ConsoleReporter {
public:
  RatioReporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration && !run.error_occurred) {
        double& best = m_best[run.run_name.args][run.run_name.function_name];
        const double time = run.GetAdjustedCPUTime();
        best = best > 0 ? std::min(best, time) : time;
      }
    ConsoleReporter::ReportRuns(runs);
  }

  void Finalize() override {
    for (const auto& [size, times] : m_best)
      for (const auto& [name, time] : times)
        if (times.contains("dense"))
          GetOutputStream() << "time / dense at " << size << " px  " << name << "  "
                            << time / times.at("dense") << '\n';
  }

private:
  std::map<std::string, std::map<std::string, double>> m_best; ///< by size, by name
};

} // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const char* const brdf = std::getenv("HAARLIGHT_BENCH_BRDF");
  const char* const light = std::getenv("HAARLIGHT_BENCH_LIGHT");
  paths = {brdf != nullptr ? brdf : "", light != nullptr ? light : ""};
  if (argc == 3)
    paths = {argv[1], argv[2]};
  else if (argc != 1) {
    std::fprintf(stderr, "usage: reference_bench [options] [BRDF.haar LIGHT.haar]\n");
    return 2;
  }
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
