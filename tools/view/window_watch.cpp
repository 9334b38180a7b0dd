#include <view/window_watch.h>

#include <wavelet/error.h>
#include <wavelet/input_file.h>

#include <filesystem>
#include <fstream>

#include <sys/stat.h>

namespace haarlight::view {
namespace {

std::string place_of_copy(const std::string& path) {
  std::error_code none;
  const std::string folder = std::filesystem::temp_directory_path(none).string();
  return (folder.empty() ? "/tmp" : folder) + '/' + base_name(path);
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

FileCopy::FileCopy(const std::string& path) : m_original(path), m_file(place_of_copy(path)) {
  if (!std::filesystem::is_regular_file(path))
    throw_input_error(path, "is no regular file");
  std::ifstream input(path, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20U);
  while (input) {
    input.read(block.data(), static_cast<std::streamsize>(block.size()));
    m_file.write(block.data(), static_cast<std::size_t>(input.gcount()));
  }
  if (!input.eof())
    throw_input_error(path, "cannot be read");
}

} // namespace haarlight::view
