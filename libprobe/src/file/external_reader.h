#pragma once
// Image files decoded by OpenEXR, libtiff, libpng and libjpeg in a separate program, so that a
// crash of a decoder, or a file that makes it take all memory or time, ends in an Error.
//
// The program sends on its standard output: a header, a text, and if the image was read, its pixels
// as floats. The receiver trusts none of it. Arguments of the program: format name, layer, part
// (empty = not chosen), soft limit of CPU seconds. Its standard input is the file.

#include "file/image_formats.h"

#include <probe/read_probe.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

namespace haarlight::probe {

struct ReaderHeader {
  std::array<char, 8> magic;
  std::uint32_t failed;     ///< 1: the text is the error message and nothing follows; 0: read
  std::uint32_t text_bytes; ///< at most max_reader_text; notes end with a line feed each
  std::int32_t width;
  std::int32_t height;
};
static_assert(sizeof(ReaderHeader) == 24);

inline constexpr std::array<char, 8> reader_magic = {'h', 'a', 'a', 'r', 'i', 'm', 'g', '1'};
inline constexpr std::uint32_t max_reader_text = 16384;

/// A file descriptor that closes itself.
struct Descriptor {
  int value = -1;
  explicit Descriptor(int descriptor) : value(descriptor) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void close() {
    if (value >= 0)
      ::close(value);
    value = -1;
  }
};

/// Runs from construction until finish(), or until destruction, which kills it.
class ReaderProcess {
public:
  /// @param input standard input of the program; its standard error is discarded
  /// @param wall_limit after which read() gives up
  /// @throws std::runtime_error if the program is missing or cannot be started
  ReaderProcess(int input, const std::vector<std::string>& arguments,
                std::chrono::seconds wall_limit);
  ~ReaderProcess();
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  /// Reads exactly this many bytes of the program's output.
  /// @return false if it wrote fewer, or the time is over
  bool read(void* bytes, std::size_t count);

  /// Ends the program, if it still runs after its output was read, and waits for it.
  /// @return how it failed, as a phrase; empty if it ended by itself with exit code 0
  std::string finish();

private:
  using Clock = std::chrono::steady_clock;

  Descriptor m_output;
  pid_t m_pid = -1;
  Clock::time_point m_deadline;
  std::chrono::seconds m_limit;
  bool m_timed_out = false;
};

/// A decoded file.
struct DecodedImage {
  Image image;                    ///< linear Rec. 709, top row first; values are not checked yet
  std::vector<std::string> notes; ///< how the values were interpreted, a sentence each
};

/// Starts the reader program on a file and waits for its result. The program runs under limits of
/// memory (by the size that the header of the file states) and of time (by the size of the file).
/// @throws Error(Input) if the file cannot be decoded, or the program crashes or exceeds a limit;
///         std::runtime_error if the program cannot be started
DecodedImage read_with_reader(const std::string& path, ImageFormat format,
                              const ImageChoice& choice);

} // namespace haarlight::probe
