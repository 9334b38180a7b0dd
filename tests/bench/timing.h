#pragma once
// Times of loops, printed.

#include <cstdio>
#include <ctime>

namespace haarlight::bench {

/// Processor time, which other programs on the machine do not lengthen.
inline double seconds_since(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Calls work(), whose result is printed so that it is not left out, and prints the time.
/// @param count what the work does so many times
template <class Work>
void report(const char* what, double count, const Work& work) {
  const auto start = std::clock();
  const double result = work();
  const double seconds = seconds_since(start);
  std::printf("%-44s %9.3f ms %9.2f ns each (check %g)\n", what, 1e3 * seconds,
              1e9 * seconds / count, result);
}

} // namespace haarlight::bench
