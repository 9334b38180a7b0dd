#pragma once
// Shared by the fuzz targets: how an input becomes a file, and which outcomes are allowed.

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
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

/// CPU time of this process, s.
inline double cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Ends the fuzzer for an input that takes more than a second of CPU time. libFuzzer's own limit is
/// of wall-clock time, which a busy machine exceeds for any input.
class TimeLimit {
public:
  ~TimeLimit() {
    if (cpu_seconds() - m_start <= 1)
      return;
    std::fputs("ERROR: took more than 1 s of CPU time\n", stderr);
    std::abort();
  }

private:
  double m_start = cpu_seconds();
};

/// Runs a reader in one thread. It may succeed or throw Error(Input); anything else that it throws
/// ends the fuzzer, which then keeps the input.
template <class F>
void read_or_refuse(F&& read) {
  static const ThreadLimit one(1); // starting threads would take most of the time of an execution
  const TimeLimit limit;
  try {
    read();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::Input)
      std::abort();
  }
}

/// Runs a reader of a path on an input. @return what LLVMFuzzerTestOneInput returns
template <class F>
int read_file(const std::uint8_t* data, std::size_t size, F&& read) {
  static MemoryFile file;
  file.assign(bytes_of(data, size));
  read_or_refuse([&] { read(file.path()); });
  return 0;
}

} // namespace haarlight::fuzzing
