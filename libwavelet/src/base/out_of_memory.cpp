#include <wavelet/base/out_of_memory.h>

#include <cstdio>

namespace haarlight {

OutOfMemory::OutOfMemory(const std::string& purpose, std::uint64_t bytes) noexcept {
  constexpr double mib = 1 << 20;
  if (bytes == 0)
    std::snprintf(m_text, sizeof m_text, "out of memory: for %s", purpose.c_str());
  else
    std::snprintf(m_text, sizeof m_text, "out of memory: %.3g MiB for %s",
                  static_cast<double>(bytes) / mib, purpose.c_str());
}

} // namespace haarlight
