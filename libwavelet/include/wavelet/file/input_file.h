#pragma once
// Whole files as read-only bytes in private memory.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace haarlight {

/// Bytes of a file, or of a pipe that is read to its end, as they were when they were read: changes
/// to the file later have no effect, and a file that changes while it is read is rejected.
/// Only parts that are read take memory.
class InputFile {
public:
  /// @param path of a regular file or a FIFO; "-" is standard input
  /// @throws Error(Input) if it is missing, unreadable, or of another kind (a directory, a device)
  explicit InputFile(const std::string& path);

  /// Memory that is filled by `fill`, under the name of a file.
  /// @throws std::bad_alloc
  template <class F>
  InputFile(std::string name, std::size_t size, F&& fill) : InputFile(std::move(name), size) {
    fill(std::span(m_data, size));
  }

  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return m_path; }
  std::size_t size() const { return m_size; }

  /// All bytes; reads those of the file at the first call. Safe from several threads.
  /// @throws Error(Input) if the file has changed since it was opened, is larger than the memory
  ///         available, or reading fails
  std::span<const std::byte> bytes() const;

  /// Some of the bytes, which are read from the file unless bytes() was called before. Not safe
  /// from several threads for parts that overlap. @param offset offset + size ≤ size()
  /// @throws as bytes()
  std::span<const std::byte> part(std::size_t offset, std::size_t size) const;

  /// The first `size` bytes, or all if there are fewer. @throws as bytes()
  std::span<const std::byte> beginning(std::size_t size) const;

  /// Where part() puts these bytes, which may not be read yet.
  const std::byte* place(std::size_t offset) const { return m_data + offset; }

private:
  struct Source;

  InputFile(std::string name, std::size_t size);
  void allocate();
  void require_memory() const;
  void release() noexcept;

  std::string m_path;
  std::byte* m_data = nullptr; ///< anonymous memory of m_size bytes
  std::size_t m_size = 0;
  std::unique_ptr<Source> m_source; ///< the file; nothing if all bytes were there from the start
};

/// Largest content of standard input or a FIFO.
inline constexpr std::uint64_t largest_stream = std::uint64_t{1} << 30U;

/// A path by which a file can be opened any number of times. For "-", FIFOs and other pipes this
/// reads the pipe to its end, once in the life of the process, and returns the path of a copy in
/// memory; for all others it returns `path`.
/// @throws Error(Input) if the pipe cannot be read, holds more than largest_stream, or has no
///         writer within two seconds
std::string openable_path(const std::string& path);

/// True for "-", "/dev/stdin" and the like, which have no folder of their own.
bool names_descriptor(const std::string& path);

/// 64-bit XXH3 of some bytes, for checksums and provenance.
std::uint64_t hash_bytes(std::span<const std::byte> bytes);

/// The same as 16 hexadecimal digits.
std::string hash_text(std::span<const std::byte> bytes);

/// The last component of a path, by which outputs name their sources: not by their folder. Standard
/// input and other open descriptors have the names "standard input" and "pipe".
std::string base_name(const std::string& path);

/// hash_text() of all bytes of a file, read in pieces. @throws Error(Input) if it cannot be read
std::string file_hash(const std::string& path);

} // namespace haarlight
