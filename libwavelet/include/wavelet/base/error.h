#pragma once
// The one error of the toolkit: I/O that failed, or data that is malformed.

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace haarlight {

/// Error category; determines the exit code.
enum class ErrorKind {
  Input, ///< a file cannot be read, or its content is malformed
  Output ///< a result cannot be written
};

/// Thrown for I/O and malformed data only; a broken precondition is an assert.
/// what() reads `path: byte N: message`, omitting unknown parts.
class Error : public std::runtime_error {
public:
  /// @param path    the file concerned, as the user named it; empty if none
  /// @param message the fault and its correction
  /// @param offset  byte offset of the trouble in the file, where one is known
  Error(ErrorKind kind, std::string path, const std::string& message,
        std::optional<std::uint64_t> offset = std::nullopt);

  ErrorKind kind() const { return m_kind; }
  const std::string& path() const { return m_path; }
  std::optional<std::uint64_t> offset() const { return m_offset; }

private:
  ErrorKind m_kind;
  std::string m_path;
  std::optional<std::uint64_t> m_offset;
};

/// Shorthands, so that a check reads as one line.
[[noreturn]] void throw_input_error(const std::string& path, const std::string& message,
                                    std::optional<std::uint64_t> offset = std::nullopt);
[[noreturn]] void throw_output_error(const std::string& path, const std::string& message);

} // namespace haarlight
