// The Haar transform beside memcpy of the same image and GSL's gsl_wavelet2d_nstransform of as many
// planes of doubles, in turns within one run. Times are the best of all turns, so that what else
// the machine does falls away; the ratios are of those.
// transform_pywavelets.py sets PyWavelets' times beside these.

#include <wavelet/transform/transform.h>

#include <benchmark/benchmark.h>

#include <gsl/gsl_wavelet2d.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

using namespace haarlight::wavelet;

namespace {

/// Seconds of the fastest run.
struct Best {
  double least = std::numeric_limits<double>::infinity();

  template <class Work>
  void time(Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    benchmark::ClobberMemory();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    least = std::min(least, time.count());
  }
};

template <class T>
std::vector<T> random_image(std::size_t elements) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<T> image(elements);
  for (T& value : image)
    value = static_cast<T>(uniform(generator));
  return image;
}

class Gsl {
public:
  Gsl(int size, int planes)
      : m_size(static_cast<std::size_t>(size)), m_planes(planes),
        m_data(random_image<double>(m_size * m_size * static_cast<std::size_t>(planes))),
        m_wavelet(gsl_wavelet_alloc(gsl_wavelet_haar, 2)),
        m_workspace(gsl_wavelet_workspace_alloc(m_size)) {}
  ~Gsl() {
    gsl_wavelet_workspace_free(m_workspace);
    gsl_wavelet_free(m_wavelet);
  }
  Gsl(const Gsl&) = delete;
  Gsl& operator=(const Gsl&) = delete;

  void run(gsl_wavelet_direction direction) {
    for (int i = 0; i < m_planes; ++i)
      gsl_wavelet2d_nstransform(m_wavelet,
                                m_data.data() + static_cast<std::size_t>(i) * m_size * m_size,
                                m_size, m_size, m_size, direction, m_workspace);
  }

private:
  std::size_t m_size;
  int m_planes;
  std::vector<double> m_data;
  gsl_wavelet* m_wavelet;
  gsl_wavelet_workspace* m_workspace;
};

/// Turns that images of a size are given, and how often each rival runs in a turn: caches, and the
/// units for wide vectors, are as warm for one as for the other.
int turns(int size) { return std::max(1, (1 << 19) / (size * size)); }
int runs(int size) { return std::max(3, (1 << 18) / (size * size)); }

/// Forward and inverse alternate, which keeps the values' magnitude.
template <class T>
void transform(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const auto channels = static_cast<int>(state.range(1));
  auto image = random_image<T>(static_cast<std::size_t>(size) * size * channels);
  std::vector<T> copy(image.size());
  Gsl gsl(size, channels);
  Best copying;
  Best forward;
  Best inverse;
  Best gsl_forward;
  Best gsl_inverse;
  const auto turn = [&] {
    for (int i = 0; i < runs(size); ++i)
      copying.time([&] { std::memcpy(copy.data(), image.data(), image.size() * sizeof(T)); });
    for (int i = 0; i < runs(size); ++i) {
      forward.time([&] { haar_forward(image.data(), size, channels); });
      inverse.time([&] { haar_inverse(image.data(), size, channels); });
    }
    gsl_forward.time([&] { gsl.run(gsl_wavelet_forward); });
    gsl_inverse.time([&] { gsl.run(gsl_wavelet_backward); });
  };
  for (auto _ : state) {
    for (int i = 0; i < turns(size); ++i)
      turn();
    state.SetIterationTime(forward.least);
  }
  state.counters["forward_us"] = 1e6 * forward.least;
  state.counters["inverse_us"] = 1e6 * inverse.least;
  state.counters["forward/memcpy"] = forward.least / copying.least;
  state.counters["inverse/memcpy"] = inverse.least / copying.least;
  state.counters["gsl/forward"] = gsl_forward.least / forward.least;
  state.counters["gsl/inverse"] = gsl_inverse.least / inverse.least;
}

void all_sizes(benchmark::internal::Benchmark* b) {
  b->UseManualTime()->Iterations(6)->ArgNames({"size", "channels"});
  for (const int channels : {1, 3})
    for (int size = 64; size <= 2048; size *= 2)
      b->Args({size, channels});
}

void largest(benchmark::internal::Benchmark* b) {
  b->UseManualTime()->Iterations(1)->ArgNames({"size", "channels"})->Args({8192, 1});
}

BENCHMARK_TEMPLATE(transform, float)->Apply(all_sizes);
BENCHMARK_TEMPLATE(transform, double)->Apply(all_sizes);
BENCHMARK_TEMPLATE(transform, float)->Apply(largest);

} // namespace

BENCHMARK_MAIN();
