#include <wavelet/file/output_file.h>

#include <wavelet/base/error.h>
#include <wavelet/file/temporary_name.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {
namespace {

constexpr mode_t usual_mode = 0666; ///< less the umask
constexpr const char* output_name = "standard output";

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  if (slash == std::string::npos)
    return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

/// A rename would put a file in the place of a device or FIFO; those must stay.
void require_replaceable(const std::string& target, const std::string& path) {
  struct stat status = {};
  if (::lstat(target.c_str(), &status) != 0) {
    if (errno == ENOENT)
      return;
    throw_output_error(path, std::string("cannot be written: ") + std::strerror(errno));
  }
  if (S_ISREG(status.st_mode))
    return;
  throw_output_error(path, S_ISDIR(status.st_mode)
                               ? "is a directory, a file name is needed"
                               : "exists and is no regular file; for a pipe write to -");
}

std::string descriptor_path(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

/// Where a link leads; nothing if there is no link at `path`.
std::string next_link(const std::string& path) {
  char text[PATH_MAX];
  const ssize_t length = ::readlink(path.c_str(), text, sizeof text);
  if (length <= 0)
    return {};
  const std::string next(text, static_cast<std::size_t>(length));
  return next[0] == '/' ? next : folder_of(path) + "/" + next;
}

} // namespace

std::string link_target(const std::string& path) {
  constexpr int most_links = 40; // as in the kernel
  std::string target = path;
  for (int i = 0; i < most_links; ++i) {
    const std::string next = next_link(target);
    if (next.empty())
      return target;
    if (next.rfind("/proc/", 0) == 0)
      throw_output_error(path, "leads to a file that is open already; for a pipe write to -");
    target = next;
  }
  throw_output_error(path, std::string("cannot be written: ") + std::strerror(ELOOP));
}

OutputFile::OutputFile(const std::string& path)
    : m_path(path == standard_output ? output_name : path) {
  if (path == standard_output)
    open_in_memory();
  else
    open_beside(path);
}

void OutputFile::open_beside(const std::string& path) {
  m_target = link_target(path);
  require_replaceable(m_target, path);
  const std::string folder = folder_of(m_target);
  remove_leftovers(folder);
  if (!open_unnamed(folder))
    open_temporary(folder);
}

OutputFile::~OutputFile() {
  if (m_descriptor >= 0)
    ::close(m_descriptor);
}

void OutputFile::fail(const char* what) const {
  throw_output_error(m_path, std::string(what) + ": " + std::strerror(errno));
}

void OutputFile::open_in_memory() {
  if (::fcntl(STDOUT_FILENO, F_GETFD) < 0)
    fail("cannot be written");
  if (::isatty(STDOUT_FILENO) == 1)
    throw_output_error(m_path, "is a terminal; redirect it to a file or a pipe");
  m_descriptor = ::memfd_create("haarlight-output", MFD_CLOEXEC);
  if (m_descriptor < 0)
    fail("cannot be collected in memory");
  m_temporary = descriptor_path(m_descriptor);
}

/// False where the file system or a missing /proc makes it impossible to name the file later.
bool OutputFile::open_unnamed(const std::string& folder) {
  m_descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, usual_mode);
  if (m_descriptor < 0)
    return false;
  m_temporary = descriptor_path(m_descriptor);
  if (::access(m_temporary.c_str(), F_OK) == 0 && lock_temporary())
    return true;
  ::close(m_descriptor);
  m_descriptor = -1;
  return false;
}

/// The lock says that this process lives; it ends with the process.
/// @return false if the lock cannot be had, or too late: the file has been removed as a leftover
bool OutputFile::lock_temporary() const {
  struct stat status = {};
  if (::flock(m_descriptor, LOCK_EX | LOCK_NB) != 0)
    return errno != EWOULDBLOCK; // without locks no leftover is removed either
  return m_name == nullptr || (::fstat(m_descriptor, &status) == 0 && status.st_nlink > 0);
}

void OutputFile::open_temporary(const std::string& folder) {
  constexpr int most_attempts = 100;
  for (int i = 0; i < most_attempts; ++i) {
    m_name = std::make_unique<TemporaryName>(temporary_path(folder));
    {
      const SignalHold hold;
      m_descriptor = ::open(m_name->path().c_str(),
                            O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOCTTY, usual_mode);
      if (m_descriptor < 0)
        m_name->release();
    }
    if (m_descriptor < 0 && errno != EEXIST)
      fail("cannot be written");
    if (m_descriptor >= 0 && lock_temporary()) {
      m_temporary = m_name->path();
      return;
    }
    if (m_descriptor >= 0)
      ::close(m_descriptor);
    m_descriptor = -1;
  }
  errno = EEXIST;
  fail("cannot be written");
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
  if (!m_target.empty() && ::fsync(m_descriptor) != 0)
    fail("cannot be written to disk");
  if (check)
    run_check(check);
  if (m_target.empty())
    copy_to_standard_output();
  else
    put_in_place();
  ::close(m_descriptor); // all is on disk, so nothing can be lost here
  m_descriptor = -1;
}

/// An error of the temporary is one of the output.
void OutputFile::run_check(const Check& check) const {
  try {
    check(m_temporary);
  } catch (const Error& error) {
    if (error.path() != m_temporary)
      throw;
    throw_output_error(m_path, std::string(error.what()).substr(m_temporary.size() + 2));
  }
}

/// A file without a name cannot replace another, so it is first linked as a temporary.
void OutputFile::put_in_place() {
  if (m_name == nullptr) {
    m_name = std::make_unique<TemporaryName>(temporary_path(folder_of(m_target)));
    const SignalHold hold;
    if (::linkat(AT_FDCWD, m_temporary.c_str(), AT_FDCWD, m_name->path().c_str(),
                 AT_SYMLINK_FOLLOW) != 0)
      fail("cannot be put in place");
  }
  const SignalHold hold;
  if (::rename(m_name->path().c_str(), m_target.c_str()) != 0)
    fail("cannot be put in place");
  m_name->release();
}

void OutputFile::copy_to_standard_output() {
  std::vector<char> block(std::size_t{1} << 16U);
  off_t position = 0;
  for (;;) {
    const ssize_t count = ::pread(m_descriptor, block.data(), block.size(), position);
    if (count < 0)
      fail("cannot be copied");
    if (count == 0)
      return;
    for (ssize_t done = 0; done < count;) {
      const ssize_t written =
          ::write(STDOUT_FILENO, block.data() + done, static_cast<std::size_t>(count - done));
      if (written < 0 && errno != EINTR)
        fail("cannot be written");
      done += std::max<ssize_t>(written, 0);
    }
    position += count;
  }
}

} // namespace haarlight
