// Execution of a program: signals, the body, its errors and its output.
#include <support/tool.h>

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/temporary_name.h>

#include <algorithm>
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

/// Opened in the wrong direction, so that using one of them still fails as a closed one does.
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

/// Prepares signals, standard descriptors and the handler of last resort. Call once, before threads
/// are started and files opened.
/// - INT, TERM, HUP, QUIT and XCPU remove temporaries and then end the process by the same signal,
///   so that a shell sees the exit code 128 + N. An ignored signal, as under nohup, stays ignored.
/// - PIPE and XFSZ are ignored: a closed pipe and a file size limit are output errors.
/// - Closed standard descriptors are opened, so that no output file becomes one of them.
/// - std::terminate prints one line, `name: …`, removes temporaries and exits with code 5.
void prepare_process(const std::string& name) {
  std::snprintf(program, sizeof program, "%s", name.c_str());
  take_closed_descriptors();
  std::set_terminate(end_by_terminate);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU})
    handle_unless_ignored(signal);
}

/// Diagnostics are one line, whatever characters a file name has.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

void say(const std::string& line) {
  const std::string text = line + '\n';
  std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace

int Tool::run(int argc, const char* const* argv, const std::function<int()>& body) {
  prepare_process(m_name);
  if (const auto code = parse(argc, argv))
    return *code;
  const ThreadLimit limit(m_threads);
  const int code = guarded([&] {
    check_files();
    return body();
  });
  if (code < exit_usage && !m_quiet)
    std::for_each(m_notes.begin(), m_notes.end(), say);
  return code;
}

int Tool::guarded(const std::function<int()>& body) const {
  try {
    return body();
  } catch (const UsageError& error) {
    return complain(exit_usage, std::string(error.what()) + " (see " + m_usage + " --help)");
  } catch (const Error& error) {
    return complain(error.kind() == ErrorKind::Input ? exit_input : exit_output, error.what());
  } catch (const OutOfMemory& error) {
    return complain(exit_internal, error.what());
  } catch (const std::bad_alloc&) {
    return complain(exit_internal, "out of memory");
  } catch (const std::exception& error) {
    return complain(exit_internal, error.what());
  }
}

int Tool::complain(int code, const std::string& message) const {
  say(m_name + ": " + one_line(message));
  return code;
}

void Tool::note(const std::string& line) const {
  const std::string text = m_name + ": " + one_line(line);
  if (m_verbose && !m_quiet)
    say(text);
  else
    m_notes.push_back(text);
}

void Tool::detail(const std::string& line) const {
  if (m_verbose)
    note(line);
}

void Tool::print(const Report& report) const { print(m_json ? report.json() : report.text()); }

void Tool::print(const std::string& text) const {
  const bool to_stderr = writes_standard_output();
  if (to_stderr && m_quiet)
    return;
  std::FILE* const stream = to_stderr ? stderr : stdout;
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (!written || std::fflush(stream) != 0)
    throw_output_error(to_stderr ? "standard error" : "standard output",
                       std::string("cannot be written: ") + std::strerror(errno));
}

} // namespace haarlight::tool
