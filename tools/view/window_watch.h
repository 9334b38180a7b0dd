#pragma once
// Files that may be rewritten while they are shown.

#include <wavelet/output_file.h>

#include <cstdint>
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

/// A copy of a file's bytes, which goes with the object: a mapping of it is safe from whoever
/// truncates the file.
class FileCopy {
public:
  /// @throws Error(Input) if the file cannot be read, Error(Output) if the folder for temporary
  ///         files takes no copy
  explicit FileCopy(const std::string& path);

  const std::string& path() const { return m_file.temporary(); }
  const std::string& original() const { return m_original; }

private:
  std::string m_original;
  OutputFile m_file;
};

} // namespace haarlight::view
