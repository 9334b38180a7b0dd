#include <support/process.h>

#include <support/tool.h>

#include <wavelet/base/memory.h>
#include <wavelet/file/temporary_name.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include <fcntl.h>
#include <unistd.h>

namespace haarlight::tool {
namespace {

char program[64]; ///< for the terminate handler, which must not allocate

extern "C" void end_by_signal(int signal) {
  remove_temporaries();
  std::signal(signal, SIG_DFL);
  sigset_t mask;
  sigemptyset(&mask);
  sigaddset(&mask, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &mask, nullptr);
  ::kill(::getpid(), signal);
  ::_exit(128 + signal); // not reached
}

void handle_unless_ignored(int signal) {
  struct sigaction action = {};
  if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN)
    return;
  action = {};
  action.sa_handler = end_by_signal;
  sigfillset(&action.sa_mask);
  ::sigaction(signal, &action, nullptr);
}

/// Opened the wrong way round: whoever uses one of them still gets the error of a closed one.
void take_closed_descriptors() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor)
    if (::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
      ::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

const char* reason() {
  static char text[256] = "internal error";
  try {
    if (const std::exception_ptr error = std::current_exception())
      std::rethrow_exception(error);
  } catch (const OutOfMemory& error) {
    std::snprintf(text, sizeof text, "%s", error.what());
  } catch (const std::bad_alloc&) {
    std::snprintf(text, sizeof text, "out of memory");
  } catch (const std::exception& error) {
    std::snprintf(text, sizeof text, "%s", error.what());
  } catch (...) { // NOLINT(bugprone-empty-catch): the text stays
  }
  return text;
}

[[noreturn]] void end_by_terminate() {
  remove_temporaries();
  char line[400];
  const int length = std::snprintf(line, sizeof line, "%s: %s\n", program, reason());
  if (::write(STDERR_FILENO, line, static_cast<std::size_t>(length)) < 0)
    ::_exit(exit_internal);
  ::_exit(exit_internal);
}

} // namespace

void prepare_process(const std::string& name) {
  std::snprintf(program, sizeof program, "%s", name.c_str());
  take_closed_descriptors();
  std::set_terminate(end_by_terminate);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU})
    handle_unless_ignored(signal);
}

} // namespace haarlight::tool
