#include <wavelet/input_file.h>

#include <wavelet/error.h>

#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {
namespace {

/// A file descriptor that closes itself.
struct Descriptor {
  int value;
  explicit Descriptor(int descriptor) : value(descriptor) {}
  ~Descriptor() {
    if (value >= 0)
      ::close(value);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

std::size_t regular_file_size(const Descriptor& file, const std::string& path) {
  struct stat status = {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0)
    throw_input_error(path, std::string("cannot be read: ") + std::strerror(errno));
  if (!S_ISREG(status.st_mode))
    throw_input_error(path, S_ISDIR(status.st_mode) ? "is a directory, a regular file is needed"
                                                    : "is no regular file");
  return static_cast<std::size_t>(status.st_size);
}

} // namespace

InputFile::InputFile(const std::string& path, std::string name) : m_path(std::move(name)) {
  // O_NONBLOCK: opening a FIFO must not hang.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  m_size = regular_file_size(file, m_path);
  if (m_size == 0)
    return;
  void* address = ::mmap(nullptr, m_size, PROT_READ, MAP_PRIVATE, file.value, 0);
  if (address == MAP_FAILED)
    throw_input_error(m_path, std::string("cannot be mapped: ") + std::strerror(errno));
  m_data = static_cast<const std::byte*>(address);
}

void InputFile::release() noexcept {
  if (m_data != nullptr)
    ::munmap(const_cast<std::byte*>(m_data), m_size);
}

InputFile::~InputFile() { release(); }

InputFile::InputFile(InputFile&& other) noexcept
    : m_path(std::move(other.m_path)), m_data(std::exchange(other.m_data, nullptr)),
      m_size(std::exchange(other.m_size, 0)) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  if (this != &other) {
    release();
    m_path = std::move(other.m_path);
    m_data = std::exchange(other.m_data, nullptr);
    m_size = std::exchange(other.m_size, 0);
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
  const auto slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

} // namespace haarlight
