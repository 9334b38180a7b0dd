// Input files, and pipes as files: a pipe is read to its end into a file in memory, which can be
// opened again and again.
#include <wavelet/file/input_file.h>

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>

#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {

/// A file descriptor that closes itself.
struct Descriptor {
  int value;
  explicit Descriptor(int descriptor) : value(descriptor) {}
  ~Descriptor() { close(); }
  void close() {
    if (value >= 0)
      ::close(value);
    value = -1;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

namespace {

[[noreturn]] void throw_unreadable(const std::string& path,
                                   std::optional<std::uint64_t> offset = std::nullopt) {
  throw_input_error(path, std::string("cannot be read: ") + std::strerror(errno), offset);
}

struct stat status_of(const Descriptor& file, const std::string& path) {
  struct stat status = {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0)
    throw_unreadable(path);
  if (!S_ISREG(status.st_mode))
    throw_input_error(path, S_ISDIR(status.st_mode)
                                ? "is a directory, a regular file is needed"
                                : "is a device, a regular file or a pipe is needed");
  return status;
}

/// Time for a program to open a FIFO for writing, ms. A shell opens both ends of a pipe at once.
constexpr int fifo_timeout = 2000;
constexpr std::size_t piece = std::size_t{1} << 18U; ///< bytes read at once

void write_all(int file, const std::byte* data, std::size_t size, const std::string& path) {
  while (size > 0) {
    const ssize_t written = ::write(file, data, size);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      throw_unreadable(path);
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
      throw_unreadable(path);
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
    throw_unreadable(path);
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
    throw_unreadable(path);
  if (!wait_for_data(fifo.value, fifo_timeout))
    throw_input_error(path, "is a FIFO that no program writes to");
  return memory_copy(fifo.value, path);
}

std::unique_ptr<Descriptor> read_standard_input(const std::string& path) {
  struct stat status = {};
  if (::fstat(STDIN_FILENO, &status) != 0)
    throw_unreadable(path);
  if (!S_ISREG(status.st_mode) && !is_stream(status, STDIN_FILENO))
    throw_input_error(path, S_ISDIR(status.st_mode) ? "is a directory, a file or a pipe is needed"
                                                    : "is a device, a file or a pipe is needed");
  return memory_copy(STDIN_FILENO, path);
}

std::string hex_digits(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
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
        throw_unreadable(path, offset + done);
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

std::string hash_text(std::span<const std::byte> bytes) { return hex_digits(hash_bytes(bytes)); }

std::string file_hash(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(openable_path(path).c_str(), "rb"), std::fclose);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  if (!file)
    throw_unreadable(path);
  XXH3_64bits_reset(state.get());
  std::vector<char> bytes(piece);
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file.get()))
    XXH3_64bits_update(state.get(), bytes.data(), count);
  if (std::ferror(file.get()) != 0)
    throw_unreadable(path);
  return hex_digits(XXH3_64bits_digest(state.get()));
}

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

std::string base_name(const std::string& path) {
  if (names_descriptor(path))
    return path == "-" || path == "/dev/stdin" ? "standard input" : "pipe";
  const auto slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

} // namespace haarlight
