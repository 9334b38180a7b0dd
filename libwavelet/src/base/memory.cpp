#include <wavelet/base/memory.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace haarlight {
namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// The number behind a name at the beginning of a line; nothing if there is none.
std::optional<std::uint64_t> number_in(const char* path, const std::string& name = "") {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name)) {
      const std::string digits =
          line.substr(std::min(line.find_first_of("0123456789"), line.size()));
      return digits.empty() ? std::nullopt : std::optional(std::stoull(digits));
    }
  return std::nullopt;
}

std::uint64_t system_memory() {
  const auto kibibytes = number_in("/proc/meminfo", "MemAvailable:");
  return kibibytes ? 1024 * *kibibytes : unlimited;
}

std::uint64_t remaining(std::uint64_t limit, std::uint64_t used) {
  return limit > used ? limit - used : 0;
}

/// Cached pages of files count as used there, but are given up when memory is needed.
std::uint64_t group_memory() {
  const auto limit = number_in("/sys/fs/cgroup/memory.max");
  const auto used = number_in("/sys/fs/cgroup/memory.current");
  const auto cached = number_in("/sys/fs/cgroup/memory.stat", "file ");
  return limit && used ? remaining(*limit, remaining(*used, cached.value_or(0))) : unlimited;
}

std::uint64_t address_space() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return unlimited;
  const auto pages = number_in("/proc/self/statm");
  return remaining(limit.rlim_cur, pages.value_or(0) * static_cast<std::uint64_t>(::getpagesize()));
}

} // namespace

std::uint64_t available_memory() {
  return std::min({system_memory(), group_memory(), address_space()});
}

OutOfMemory::OutOfMemory(const std::string& purpose, std::uint64_t bytes) noexcept {
  constexpr double mib = 1 << 20;
  if (bytes == 0)
    std::snprintf(m_text, sizeof m_text, "out of memory: for %s", purpose.c_str());
  else
    std::snprintf(m_text, sizeof m_text, "out of memory: %.3g MiB for %s",
                  static_cast<double>(bytes) / mib, purpose.c_str());
}

} // namespace haarlight
