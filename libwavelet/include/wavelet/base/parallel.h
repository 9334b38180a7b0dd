#pragma once
// All the threading that code of this toolkit sees. Results never depend on the number of threads:
// every index writes its own place, and nothing is reduced across threads.

#include <cstddef>
#include <functional>

namespace haarlight {

/// Calls body(begin, end) on disjoint ranges covering [0, count), from several threads.
/// An exception from a body stops the loop and is rethrown here. Where the system refuses further
/// threads, those that exist do the work. Loops may be nested.
/// @param grain indices a range holds at least, if there are as many
void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body);

/// Calls body(i) for every i in [0, count), from several threads.
inline void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  parallel_ranges(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      body(i);
  });
}

/// Bounds the threads of this process while it lives; 0 = as many as the machine offers. More than
/// the process has CPUs are never used, nor more than an outer limit allows.
class ThreadLimit {
public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
  int m_previous;
};

/// Threads that parallel_for uses now.
int thread_count();

} // namespace haarlight
