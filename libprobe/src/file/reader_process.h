#pragma once
// The reader program as a child process, and the pipe from it.

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

namespace haarlight::probe {

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

  /// Reads exactly this many bytes of what the program writes.
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

} // namespace haarlight::probe
