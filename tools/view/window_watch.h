#pragma once
// Files that may be rewritten while they are shown.

#include <wavelet/base/error.h>
#include <wavelet/file/temporary_name.h>

#include <cstdint>
#include <list>
#include <string>
#include <vector>

namespace haarlight::view {

/// Tells when files have become others, by their sizes, times and inodes.
class FileWatch {
public:
  explicit FileWatch(std::vector<std::string> paths);

  /// To be asked from time to time, some tenths of a second apart.
  /// @return true once for each change, as soon as the files are the same as when last asked; a
  ///         missing file is a change as well
  bool changed();

private:
  using Stamp = std::vector<std::int64_t>;
  Stamp stamp() const;

  std::vector<std::string> m_paths;
  Stamp m_known;  ///< of the version last told of
  Stamp m_latest; ///< when last asked
};

/// A folder for temporary files, made for this object. It is locked, so that only leftovers of dead
/// processes are removed.
class TemporaryFolder {
public:
  /// @throws Error(Output) if it cannot be made
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return m_name.path(); }

private:
  TemporaryName m_name;
  int m_lock = -1;
};

/// A copy of a file's bytes, safe from programs that rewrite the file. It is removed with the
/// object, and when a signal ends the process.
class FileCopy {
public:
  /// @throws Error(Input) if the file cannot be read, Error(Output) if the folder for temporary
  ///         files takes no copy
  explicit FileCopy(const std::string& path);

  /// Of the same name, in a folder of its own.
  const std::string& path() const { return m_copy.path(); }
  const std::string& original() const { return m_original; }

private:
  std::string m_original;
  TemporaryFolder m_folder;
  TemporaryName m_copy; ///< destroyed before its folder
};

/// Copies of the files that something is made of.
class FileCopies {
public:
  /// Makes a path name a copy, unless it is empty. @throws as FileCopy
  void take(std::string& path);

  /// The same error of the file that was copied.
  Error told_of_originals(const Error& error) const;

private:
  std::list<FileCopy> m_copies;
};

} // namespace haarlight::view
