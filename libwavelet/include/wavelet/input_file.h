#pragma once
// Whole files as read-only bytes, mapped rather than read.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace haarlight {

/// A regular file mapped into memory. Pages are read when touched and shared between processes. A
/// file replaced by rename while mapped stays as it was; one truncated in place must not be
/// touched.
class InputFile {
public:
  /// @throws Error(Input) if the file is missing, unreadable, or no regular file (a directory, FIFO
  /// …)
  explicit InputFile(const std::string& path) : InputFile(path, path) {}
  /// @param name what path() says, and errors with it
  InputFile(const std::string& path, std::string name);
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return m_path; }
  std::span<const std::byte> bytes() const { return {m_data, m_size}; }

private:
  void release() noexcept;

  std::string m_path;
  const std::byte* m_data = nullptr;
  std::size_t m_size = 0;
};

/// 64-bit XXH3 of some bytes; what checksums and provenance hashes are made of.
std::uint64_t hash_bytes(std::span<const std::byte> bytes);

/// The same as 16 hexadecimal digits.
std::string hash_text(std::span<const std::byte> bytes);

/// The last component of a path: outputs name their sources without telling where they lay.
std::string base_name(const std::string& path);

} // namespace haarlight
