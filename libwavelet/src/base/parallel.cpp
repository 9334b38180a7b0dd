#include <wavelet/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include <sched.h>

namespace haarlight {
namespace {

using Body = std::function<void(std::size_t, std::size_t)>;

/// Ranges per thread that the indices left are cut into: the first ranges are long, the last ones
/// short, so that threads finish together.
constexpr std::size_t ranges_per_thread = 4;

/// One call of parallel_ranges.
class Loop {
public:
  Loop(std::size_t count, std::size_t grain, std::size_t threads, const Body& body)
      : m_count(count), m_grain(std::max<std::size_t>(grain, 1)),
        m_divisor(ranges_per_thread * threads), m_body(body) {}

  bool open() const { return m_next.load() < m_count; }

  /// Takes ranges until none is left. @throws what the body throws
  void work() {
    std::size_t begin = m_next.load();
    while (begin < m_count) {
      const std::size_t end = begin + length_from(begin);
      if (!m_next.compare_exchange_weak(begin, end))
        continue;
      m_body(begin, end);
      begin = m_next.load();
    }
  }

  void close() { m_next = m_count; }

  // Guarded by the pool's mutex.
  std::exception_ptr error;
  int helpers = 0; ///< threads of the pool that work on this
  Loop* older = nullptr;

private:
  std::size_t length_from(std::size_t begin) const {
    const std::size_t left = m_count - begin;
    const std::size_t length = std::max(m_grain, left / m_divisor);
    return left < length + m_grain ? left : length;
  }

  std::size_t m_count;
  std::size_t m_grain;
  std::size_t m_divisor;
  const Body& m_body;
  std::atomic<std::size_t> m_next = 0;
};

/// CPUs this process may run on.
int available_cpus() {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  if (::sched_getaffinity(0, sizeof cpus, &cpus) == 0)
    return std::max(CPU_COUNT(&cpus), 1);
  return std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

std::atomic<int> current_limit = 0; ///< of threads; 0 = none

/// Threads that wait for loops and help with them. The caller of a loop works on it as well and
/// waits for its helpers only, so that loops may be nested, and every loop ends even if no thread
/// could be started.
class Pool {
public:
  void run(Loop& loop, int threads) {
    {
      const std::lock_guard lock(m_mutex);
      while (m_workers < threads - 1 && start_worker())
        ;
      loop.older = m_newest;
      m_newest = &loop;
    }
    m_loop_added.notify_all();
    work_on(loop);
    std::unique_lock lock(m_mutex);
    remove(loop);
    m_helper_left.wait(lock, [&] { return loop.helpers == 0; });
    if (loop.error)
      std::rethrow_exception(loop.error);
  }

private:
  /// False where the system has no further thread or no memory for its stack.
  bool start_worker() noexcept {
    try {
      std::thread([this] { help(); }).detach();
    } catch (const std::exception&) {
      return false;
    }
    ++m_workers;
    return true;
  }

  [[noreturn]] void help() {
    std::unique_lock lock(m_mutex);
    for (;;) {
      Loop* loop = nullptr;
      m_loop_added.wait(lock, [&] { return (loop = open_loop()) != nullptr; });
      ++m_busy;
      ++loop->helpers;
      lock.unlock();
      work_on(*loop);
      lock.lock();
      --m_busy;
      if (--loop->helpers == 0)
        m_helper_left.notify_all();
    }
  }

  void work_on(Loop& loop) noexcept {
    try {
      loop.work();
    } catch (...) {
      const std::lock_guard lock(m_mutex);
      loop.close();
      if (!loop.error)
        loop.error = std::current_exception();
    }
  }

  /// The newest first: the older ones may wait for it.
  Loop* open_loop() const {
    if (m_busy >= thread_count() - 1)
      return nullptr;
    Loop* loop = m_newest;
    while (loop != nullptr && !loop->open())
      loop = loop->older;
    return loop;
  }

  void remove(const Loop& loop) {
    Loop** place = &m_newest;
    while (*place != &loop)
      place = &(*place)->older;
    *place = loop.older;
  }

  std::mutex m_mutex;
  std::condition_variable m_loop_added;
  std::condition_variable m_helper_left;
  Loop* m_newest = nullptr;
  int m_workers = 0;
  int m_busy = 0; ///< workers that work on a loop
};

/// Never destroyed, since its threads wait on it until the process ends.
Pool& pool() {
  static Pool* const instance = new Pool;
  return *instance;
}

} // namespace

void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0)
    return;
  const std::size_t ranges = (count - 1) / std::max<std::size_t>(grain, 1) + 1;
  const auto threads = std::min(ranges, static_cast<std::size_t>(thread_count()));
  if (threads == 1)
    return body(0, count);
  Loop loop(count, grain, threads, body);
  pool().run(loop, static_cast<int>(threads));
}

ThreadLimit::ThreadLimit(int threads) : m_previous(current_limit) {
  if (threads > 0)
    current_limit = m_previous > 0 ? std::min(m_previous, threads) : threads;
}

ThreadLimit::~ThreadLimit() { current_limit = m_previous; }

int thread_count() {
  static const int available = available_cpus();
  const int limit = current_limit;
  return limit > 0 ? std::min(limit, available) : available;
}

} // namespace haarlight
