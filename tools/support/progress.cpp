#include <support/progress.h>

#include <support/tool.h>

#include <algorithm>
#include <cstdio>

#include <unistd.h>

namespace haarlight::tool {
namespace {

constexpr double first_after = 0.5; ///< seconds of work before anything is drawn
constexpr double redraw_after = 0.1;
constexpr int bar_width = 30;

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

void draw(const std::string& what, double share, double left) {
  const int filled = static_cast<int>(share * bar_width);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(bar_width - filled), '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%, %.0f s left", what.c_str(), bar.c_str(),
               100 * share, left);
}

} // namespace

ProgressBar::ProgressBar(const Tool& tool, std::string what)
    : m_what(std::move(what)), m_start(Clock::now()), m_last(m_start),
      m_enabled(!tool.quiet() && ::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (m_drawn)
    std::fputs("\r\033[K", stderr);
}

void ProgressBar::operator()(int done, int total) {
  if (!m_enabled || total <= 0 || done <= 0)
    return;
  const std::lock_guard lock(m_mutex);
  const auto now = Clock::now();
  const double spent = seconds(now - m_start);
  if (spent < first_after || (m_drawn && seconds(now - m_last) < redraw_after))
    return;
  const double share = std::clamp(static_cast<double>(done) / total, 0.0, 1.0);
  draw(m_what, share, spent / share - spent);
  m_last = now;
  m_drawn = true;
}

} // namespace haarlight::tool
