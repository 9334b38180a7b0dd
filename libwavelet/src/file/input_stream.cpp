// Pipes as files: read to their end into a file in memory, which can be opened again and again.
#include "file/descriptor.h"

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {
namespace {

/// Time for a program to open a FIFO for writing, ms. A shell opens both ends of a pipe at once.
constexpr int patience = 2000;
constexpr std::size_t piece = std::size_t{1} << 18U;

[[noreturn]] void fail(const std::string& path) {
  throw_input_error(path, std::string("cannot be read: ") + std::strerror(errno));
}

void write_all(int file, const std::byte* data, std::size_t size, const std::string& path) {
  while (size > 0) {
    const ssize_t written = ::write(file, data, size);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      fail(path);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

/// Waits until there is something to read, or the end. @param limit in ms, −1 = none
bool wait_for_data(int stream, int limit) {
  pollfd poll = {stream, POLLIN, 0};
  int ready = 0;
  do
    ready = ::poll(&poll, 1, limit);
  while (ready < 0 && errno == EINTR);
  return ready != 0;
}

void copy_stream(int stream, int copy, const std::string& path) {
  std::vector<std::byte> bytes(piece);
  for (std::uint64_t total = 0;;) {
    const ssize_t count = ::read(stream, bytes.data(), bytes.size());
    if (count == 0)
      return;
    if (count < 0 && errno == EAGAIN)
      wait_for_data(stream, -1);
    else if (count < 0 && errno != EINTR)
      fail(path);
    total += static_cast<std::uint64_t>(std::max<ssize_t>(count, 0));
    if (total > largest_stream)
      throw_input_error(path, "holds more than 1 GiB, which a pipe may hold at most; a file is "
                              "needed");
    write_all(copy, bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)), path);
  }
}

/// A file in memory with all that comes out of a stream.
std::unique_ptr<Descriptor> memory_copy(int stream, const std::string& path) {
  auto copy = std::make_unique<Descriptor>(::memfd_create("haarlight", MFD_CLOEXEC));
  if (copy->value < 0)
    fail(path);
  copy_stream(stream, copy->value, path);
  return copy;
}

bool is_stream(const struct stat& status, int stream) {
  return S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) ||
         (S_ISCHR(status.st_mode) && ::isatty(stream) != 0);
}

/// Nothing if `path` is no pipe.
std::unique_ptr<Descriptor> read_fifo(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode))
    return nullptr;
  // O_NONBLOCK: opening a FIFO without a writer must not hang.
  const Descriptor fifo(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (fifo.value < 0)
    fail(path);
  if (!wait_for_data(fifo.value, patience))
    throw_input_error(path, "is a FIFO that no program writes to");
  return memory_copy(fifo.value, path);
}

std::unique_ptr<Descriptor> read_standard_input(const std::string& path) {
  struct stat status = {};
  if (::fstat(STDIN_FILENO, &status) != 0)
    fail(path);
  if (!S_ISREG(status.st_mode) && !is_stream(status, STDIN_FILENO))
    throw_input_error(path, S_ISDIR(status.st_mode) ? "is a directory, a file or a pipe is needed"
                                                    : "is a device, a file or a pipe is needed");
  return memory_copy(STDIN_FILENO, path);
}

} // namespace

std::string openable_path(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<Descriptor>> copies;
  const std::lock_guard lock(mutex);
  auto found = copies.find(path);
  if (found == copies.end()) {
    auto copy = path == "-" ? read_standard_input(path) : read_fifo(path);
    if (!copy)
      return path;
    found = copies.emplace(path, std::move(copy)).first;
  }
  return "/proc/self/fd/" + std::to_string(found->second->value);
}

bool names_descriptor(const std::string& path) {
  return path == "-" || path == "/dev/stdin" || path.starts_with("/dev/fd/") ||
         path.starts_with("/proc/self/fd/");
}

} // namespace haarlight
