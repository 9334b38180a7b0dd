#include <wavelet/file/input_file.h>

#include "file/descriptor.h"

#include <wavelet/base/available_memory.h>
#include <wavelet/base/error.h>
#include <wavelet/base/out_of_memory.h>

#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {
namespace {

struct stat status_of(const Descriptor& file, const std::string& path) {
  struct stat status = {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0)
    throw_input_error(path, std::string("cannot be read: ") + std::strerror(errno));
  if (!S_ISREG(status.st_mode))
    throw_input_error(path, S_ISDIR(status.st_mode)
                                ? "is a directory, a regular file is needed"
                                : "is a device, a regular file or a pipe is needed");
  return status;
}

} // namespace

struct InputFile::Source {
  Descriptor file;
  struct stat opened;
  std::once_flag once;
  std::atomic<bool> whole = false; ///< all bytes have been read

  Source(const std::string& path, const std::string& name)
      : file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)),
        opened(status_of(file, name)) {}

  void read(std::span<std::byte> to, std::size_t offset, const std::string& path) const {
    for (std::size_t done = 0; done < to.size();) {
      const ssize_t count = ::pread(file.value, to.data() + done, to.size() - done,
                                    static_cast<off_t>(offset + done));
      if (count < 0 && errno == EINTR)
        continue;
      if (count < 0)
        throw_input_error(path, std::string("cannot be read: ") + std::strerror(errno),
                          offset + done);
      if (count == 0)
        throw_input_error(path, "was truncated while it was read", offset + done);
      done += static_cast<std::size_t>(count);
    }
    struct stat now = {};
    if (::fstat(file.value, &now) != 0 || now.st_size != opened.st_size ||
        now.st_mtim.tv_sec != opened.st_mtim.tv_sec ||
        now.st_mtim.tv_nsec != opened.st_mtim.tv_nsec)
      throw_input_error(path, "was changed while it was read");
  }
};

InputFile::InputFile(const std::string& path) : m_path(path) {
  m_source = std::make_unique<Source>(openable_path(path), path);
  m_size = static_cast<std::size_t>(m_source->opened.st_size);
  allocate();
}

InputFile::InputFile(std::string name, std::size_t size) : m_path(std::move(name)), m_size(size) {
  allocate();
}

/// Pages that are never touched take no memory.
void InputFile::allocate() {
  if (m_size == 0)
    return;
  void* address = ::mmap(nullptr, m_size, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (address == MAP_FAILED)
    throw OutOfMemory("the contents of " + m_path, m_size);
  m_data = static_cast<std::byte*>(address);
}

std::span<const std::byte> InputFile::bytes() const {
  if (m_source)
    std::call_once(m_source->once, [&] {
      require_memory();
      m_source->read({m_data, m_size}, 0, m_path);
      m_source->whole.store(true, std::memory_order_release);
      m_source->file.close();
    });
  return {m_data, m_size};
}

void InputFile::require_memory() const {
  const std::uint64_t available = available_memory();
  if (m_size > available)
    throw_input_error(m_path, "has " + std::to_string(m_size) + " bytes, of memory only " +
                                  std::to_string(available) + " are available");
}

std::span<const std::byte> InputFile::part(std::size_t offset, std::size_t size) const {
  assert(offset <= m_size && size <= m_size - offset);
  const std::span<std::byte> to(m_data + offset, size);
  if (m_source && !m_source->whole.load(std::memory_order_acquire))
    m_source->read(to, offset, m_path);
  return to;
}

std::span<const std::byte> InputFile::beginning(std::size_t size) const {
  return part(0, std::min(size, m_size));
}

void InputFile::release() noexcept {
  if (m_data != nullptr)
    ::munmap(m_data, m_size);
}

InputFile::~InputFile() { release(); }

InputFile::InputFile(InputFile&& other) noexcept
    : m_path(std::move(other.m_path)), m_data(std::exchange(other.m_data, nullptr)),
      m_size(std::exchange(other.m_size, 0)), m_source(std::move(other.m_source)) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  if (this != &other) {
    release();
    m_path = std::move(other.m_path);
    m_data = std::exchange(other.m_data, nullptr);
    m_size = std::exchange(other.m_size, 0);
    m_source = std::move(other.m_source);
  }
  return *this;
}

std::uint64_t hash_bytes(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::string hash_text(std::span<const std::byte> bytes) {
  static constexpr char digits[] = "0123456789abcdef";
  const std::uint64_t hash = hash_bytes(bytes);
  std::string text(16, '0');
  for (int i = 0; i < 16; ++i)
    text[static_cast<std::size_t>(i)] = digits[(hash >> (60 - 4 * i)) & 15U];
  return text;
}

std::string base_name(const std::string& path) {
  if (names_descriptor(path))
    return path == "-" || path == "/dev/stdin" ? "standard input" : "pipe";
  const auto slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

} // namespace haarlight
