#include <wavelet/parallel.h>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

namespace haarlight {

namespace tbb = oneapi::tbb;

void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const auto& range) { body(range.begin(), range.end()); });
}

ThreadLimit::ThreadLimit(int threads)
    : m_control(threads > 0 ? new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(threads))
                            : nullptr) {}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(m_control); }

int thread_count() {
  const auto allowed =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(static_cast<int>(allowed), tbb::this_task_arena::max_concurrency());
}

} // namespace haarlight
