#pragma once
// Outputs that appear whole or not at all.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace haarlight {

/// Writes to a temporary beside `path` and renames it on commit(). Until then, and if anything goes
/// wrong, a file already at `path` stays as it was and the temporary is removed.
class OutputFile {
public:
  /// Reads the finished temporary back; throws if it is not what it should be.
  using Check = std::function<void(const std::string& temporary_path)>;

  /// @throws Error(Output) if the directory is missing or not writable, or `path` is a directory
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return m_path; }
  /// Where the bytes lie until commit().
  const std::string& temporary() const { return m_temporary; }

  /// Appends at the current position. @throws Error(Output), for example when the disk is full
  void write(const void* data, std::size_t size);
  std::uint64_t position() const { return m_position; }
  void seek(std::uint64_t position) { m_position = position; }

  /// Flushes to disk, runs `check` on the temporary, and gives it its name. @throws Error(Output)
  void commit(const Check& check = {});

private:
  [[noreturn]] void fail(const char* what) const;

  std::string m_path;
  std::string m_temporary;
  int m_descriptor = -1;
  std::uint64_t m_position = 0;
};

} // namespace haarlight
