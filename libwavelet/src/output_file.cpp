#include <wavelet/output_file.h>

#include <wavelet/error.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {
namespace {

/// mkstemp makes files private; give them the mode any new file would get.
void use_default_mode(int descriptor) {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(descriptor, 0666 & ~mask);
}

/// A rename would put a file in the place of a device or FIFO; those must stay.
void require_replaceable(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode))
    return;
  throw_output_error(path, S_ISDIR(status.st_mode) ? "is a directory, a file name is needed"
                                                   : "exists and is no regular file");
}

} // namespace

OutputFile::OutputFile(const std::string& path) : m_path(path) {
  require_replaceable(path);
  std::string name = path + ".tmp.XXXXXX";
  m_descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (m_descriptor < 0)
    fail("cannot be written");
  m_temporary = name;
  use_default_mode(m_descriptor);
}

OutputFile::~OutputFile() {
  if (m_descriptor >= 0)
    ::close(m_descriptor);
  if (!m_temporary.empty())
    ::unlink(m_temporary.c_str());
}

void OutputFile::fail(const char* what) const {
  throw_output_error(m_path, std::string(what) + ": " + std::strerror(errno));
}

void OutputFile::write(const void* data, std::size_t size) {
  const char* next = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = ::pwrite(m_descriptor, next, size, static_cast<off_t>(m_position));
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      fail("cannot be written");
    next += written;
    size -= static_cast<std::size_t>(written);
    m_position += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::commit(const Check& check) {
  if (::fsync(m_descriptor) != 0)
    fail("cannot be written to disk");
  const int descriptor = m_descriptor;
  m_descriptor = -1;
  if (::close(descriptor) != 0)
    fail("cannot be closed");
  if (check)
    check(m_temporary);
  if (::rename(m_temporary.c_str(), m_path.c_str()) != 0)
    fail("cannot be put in place");
  m_temporary.clear();
}

} // namespace haarlight
