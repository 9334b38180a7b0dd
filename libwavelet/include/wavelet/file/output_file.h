#pragma once
// Outputs that appear whole or not at all.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace haarlight {

class TemporaryName;

/// Stands for standard output where a path of an output is asked for.
inline constexpr const char* standard_output = "-";

/// A file that gets its name on commit(). Until then, and after any error, a file already at the
/// path stays unchanged and nothing of the new one remains. The bytes are in a file without a name
/// in the same folder; where the file system has no such files, in a temporary (see
/// temporary_name.h). A symbolic link is written through: the file that it leads to is replaced and
/// the link stays. For standard output the bytes are collected in memory.
class OutputFile {
public:
  /// Reads the finished file back; throws if it is wrong.
  using Check = std::function<void(const std::string& temporary_path)>;

  /// @throws Error(Output) if the directory is missing or not writable, if `path` is a directory,
  ///         a FIFO or a device, or too long, and if standard output is a terminal
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return m_path; }
  /// A path by which the bytes can be read until commit().
  const std::string& temporary() const { return m_temporary; }

  /// Appends at the current position. @throws Error(Output), for example when the disk is full
  void write(const void* data, std::size_t size);
  std::uint64_t position() const { return m_position; }
  void seek(std::uint64_t position) { m_position = position; }

  /// Flushes to disk, runs `check` on the finished bytes, and gives the file its name.
  /// @throws Error(Output)
  void commit(const Check& check = {});

private:
  [[noreturn]] void fail(const char* what) const;
  void open_in_memory();
  void open_beside(const std::string& path);
  bool open_unnamed(const std::string& folder);
  void open_temporary(const std::string& folder);
  bool lock_temporary() const;
  void run_check(const Check& check) const;
  void put_in_place();
  void copy_to_standard_output();

  std::string m_path;                    ///< as the user gave it; for messages
  std::string m_target;                  ///< where its links lead; empty for standard output
  std::string m_temporary;               ///< for readers
  std::unique_ptr<TemporaryName> m_name; ///< nothing if the file has no name yet
  int m_descriptor = -1;
  std::uint64_t m_position = 0;
};

/// The path that is written for `path`: the end of its chain of symbolic links, which need not
/// exist. @throws Error(Output) for a loop of links and for links to open files, as in /proc
std::string link_target(const std::string& path);

} // namespace haarlight
