#pragma once
// Names of temporary files, which are removed even if a signal ends the process.

#include <csignal>
#include <cstddef>
#include <string>

namespace haarlight {

/// Owns the name of a temporary file or of an empty folder. Whatever has this name is removed by
/// the destructor, and by remove_temporaries().
class TemporaryName {
public:
  /// Construct it before the file is made, so that there is no time at which a signal leaves it.
  explicit TemporaryName(std::string path);
  ~TemporaryName();
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;

  const std::string& path() const { return m_path; }
  /// The name is no longer a temporary: it was given away by a rename, or is somebody else's.
  void release();

private:
  std::string m_path;
  std::size_t m_slot;
};

/// While one exists, no signal handler gets past remove_temporaries(). For the moments in which
/// names are made or renamed.
class SignalHold {
public:
  SignalHold();
  ~SignalHold();
  SignalHold(const SignalHold&) = delete;
  SignalHold& operator=(const SignalHold&) = delete;

private:
  sigset_t m_mask; ///< of the thread, before
};

/// Removes everything that a TemporaryName owns. For handlers of signals that end the process:
/// async-signal-safe, and later SignalHolds of other threads never return.
void remove_temporaries() noexcept;

/// A new name in `folder` for a temporary of this process: it holds the host and the process, and
/// its length does not depend on any other name.
std::string temporary_path(const std::string& folder);

/// Removes the temporaries that processes of this host left in `folder` when they were killed.
/// Those of live processes are locked (flock) and stay, as do those of other hosts.
/// Each folder is searched once per process.
void remove_leftovers(const std::string& folder);

} // namespace haarlight
