#include <view/window_watch.h>

#include <wavelet/file/input_file.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight::view {
namespace {

namespace fs = std::filesystem;

std::string temporary_root() {
  std::error_code none;
  const fs::path root = fs::temp_directory_path(none);
  return root.empty() ? "/tmp" : root.string();
}

void copy_bytes(const std::string& from, const std::string& to) {
  std::error_code none;
  if (!fs::is_regular_file(from, none))
    throw_input_error(from, "is no regular file");
  std::ifstream input(from, std::ios::binary);
  std::ofstream output(to, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20U);
  while (input && output) {
    input.read(block.data(), static_cast<std::streamsize>(block.size()));
    output.write(block.data(), input.gcount());
  }
  output.close();
  if (!output)
    throw_output_error(to, "cannot be written");
  if (!input.eof())
    throw_input_error(from, "cannot be read");
}

} // namespace

FileWatch::FileWatch(std::vector<std::string> paths)
    : m_paths(std::move(paths)), m_known(stamp()), m_latest(m_known) {}

bool FileWatch::changed() {
  const Stamp now = stamp();
  const bool settled = now == m_latest;
  m_latest = now;
  if (!settled || now == m_known)
    return false;
  m_known = now;
  return true;
}

FileWatch::Stamp FileWatch::stamp() const {
  Stamp result;
  for (const std::string& path : m_paths) {
    struct stat status = {};
    if (::stat(path.c_str(), &status) != 0)
      status = {};
    result.insert(result.end(), {static_cast<std::int64_t>(status.st_ino), status.st_size,
                                 status.st_mtim.tv_sec, status.st_mtim.tv_nsec});
  }
  return result;
}

TemporaryFolder::TemporaryFolder() : m_name(temporary_path(temporary_root())) {
  remove_leftovers(temporary_root());
  const std::string name = m_name.path();
  const SignalHold hold;
  if (::mkdir(name.c_str(), S_IRWXU) != 0) {
    const int error = errno;
    m_name.release();
    throw_output_error(name, std::string("cannot be made: ") + std::strerror(error));
  }
  m_lock = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (m_lock < 0 || ::flock(m_lock, LOCK_EX | LOCK_NB) != 0)
    throw_output_error(name, std::string("cannot be locked: ") + std::strerror(errno));
}

TemporaryFolder::~TemporaryFolder() { ::close(m_lock); }

FileCopy::FileCopy(const std::string& path)
    : m_original(path), m_copy(m_folder.path() + '/' + base_name(path)) {
  copy_bytes(path, m_copy.path());
}

void FileCopies::take(std::string& path) {
  if (!path.empty())
    path = m_copies.emplace_back(path).path();
}

Error FileCopies::told_of_originals(const Error& error) const {
  const std::string text = error.what();
  for (const FileCopy& copy : m_copies)
    if (error.path() == copy.path())
      return {error.kind(), copy.original(), text.substr(copy.path().size() + 2)};
  return error;
}

} // namespace haarlight::view
