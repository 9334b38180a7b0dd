#pragma once
// Shared by the fuzz targets: how an input becomes a file, and which outcomes are allowed.

#include <wavelet/base/error.h>

#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

namespace haarlight::fuzzing {

/// A file in memory for readers that take a path.
class MemoryFile {
public:
  MemoryFile() : m_descriptor(::memfd_create("fuzz", MFD_CLOEXEC)) {
    if (m_descriptor < 0)
      std::abort();
  }
  ~MemoryFile() { ::close(m_descriptor); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(m_descriptor); }

  /// The file becomes `size` zero bytes. The pages of earlier contents are given back.
  void clear(std::uint64_t size) {
    if (::ftruncate(m_descriptor, 0) != 0 ||
        ::ftruncate(m_descriptor, static_cast<off_t>(size)) != 0)
      std::abort();
  }

  void put(std::uint64_t offset, std::span<const std::byte> bytes) {
    const ssize_t size =
        ::pwrite(m_descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (size != static_cast<ssize_t>(bytes.size()))
      std::abort();
  }

  void assign(std::span<const std::byte> bytes) {
    clear(bytes.size());
    put(0, bytes);
  }

private:
  int m_descriptor;
};

inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
  return std::as_bytes(std::span(data, size));
}

/// Runs a reader. It may succeed or throw Error(Input); anything else that it throws ends the
/// fuzzer, which then keeps the input.
template <class F>
void read_or_refuse(F&& read) {
  try {
    read();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::Input)
      std::abort();
  }
}

} // namespace haarlight::fuzzing
