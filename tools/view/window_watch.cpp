#include <view/window_watch.h>

#include <wavelet/file/input_file.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <stdlib.h>
#include <sys/stat.h>

namespace haarlight::view {
namespace {

namespace fs = std::filesystem;

/// A new folder, for nobody else.
std::string make_folder() {
  std::error_code none;
  const fs::path root = fs::temp_directory_path(none);
  std::string name = ((root.empty() ? fs::path("/tmp") : root) / "haarview.XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw_output_error(name, std::string("cannot be made: ") + std::strerror(errno));
  return name;
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

FileCopy::FileCopy(const std::string& path)
    : m_original(path), m_folder(make_folder()), m_path(m_folder + '/' + base_name(path)) {
  try {
    copy_bytes(path, m_path);
  } catch (const Error&) {
    std::error_code none;
    fs::remove_all(m_folder, none);
    throw;
  }
}

FileCopy::~FileCopy() {
  std::error_code none;
  fs::remove_all(m_folder, none);
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
