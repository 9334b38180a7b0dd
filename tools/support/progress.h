#pragma once
// A progress bar with the estimated remaining time.

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

namespace haarlight::tool {

class Tool;

/// Draws on stderr, only if that is a terminal, the program is not --quiet and the work has lasted
/// half a second. Callable from several threads.
class ProgressBar {
public:
  /// @param what describes the work, as in "compressing maps"
  ProgressBar(const Tool& tool, std::string what);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void operator()(int done, int total);

  /// The same as a function, in the form that libraries take; this bar must outlive it.
  std::function<void(int done, int total)> callback() {
    return [this](int done, int total) { (*this)(done, total); };
  }

private:
  using Clock = std::chrono::steady_clock;

  std::mutex m_mutex;
  std::string m_what;
  Clock::time_point m_start;
  Clock::time_point m_last;
  bool m_enabled;
  bool m_drawn = false;
};

} // namespace haarlight::tool
