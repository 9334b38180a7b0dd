// Runs a program with limits and says how it ended. Usage: limited SECONDS MEBIBYTES PROGRAM
// ARGUMENTS… The last line on stdout, after what the program wrote there was discarded, is
//   OUTCOME MEBIBYTES LINES
// OUTCOME: exit-N, signal-N or timeout. MEBIBYTES: the largest resident set of the program and of
// the children it waited for. LINES: lines that it wrote to stderr.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

[[noreturn]] void run_program(char** command, int error_pipe, long mebibytes) {
  ::setpgid(0, 0);
  // Address space is larger than resident memory; this only stops what would exhaust the machine.
  const rlimit memory{static_cast<rlim_t>(mebibytes) << 22, static_cast<rlim_t>(mebibytes) << 22};
  ::setrlimit(RLIMIT_AS, &memory);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::dup2(::open("/dev/null", O_RDONLY), 0);
  ::dup2(::open("/dev/null", O_WRONLY), 1);
  ::dup2(error_pipe, 2);
  ::execv(command[0], command);
  std::perror(command[0]);
  std::_Exit(127);
}

/// Reads stderr until its end or the time limit. @return lines, or −1 at the time limit
long read_lines(int pipe, double seconds) {
  timespec start{};
  clock_gettime(CLOCK_MONOTONIC, &start);
  long lines = 0;
  for (;;) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const double left = seconds - static_cast<double>(now.tv_sec - start.tv_sec) -
                        1e-9 * static_cast<double>(now.tv_nsec - start.tv_nsec);
    pollfd wait{pipe, POLLIN, 0};
    if (left <= 0 || ::poll(&wait, 1, static_cast<int>(1000 * left) + 1) == 0)
      return -1;
    char buffer[4096];
    const ssize_t count = ::read(pipe, buffer, sizeof buffer);
    if (count <= 0)
      return lines;
    lines += std::count(buffer, buffer + count, '\n');
  }
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fputs("usage: limited SECONDS MEBIBYTES PROGRAM ARGUMENTS...\n", stderr);
    return 2;
  }
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return 5;
  const pid_t child = ::fork();
  if (child == 0)
    run_program(argv + 3, ends[1], std::atol(argv[2]));
  ::close(ends[1]);
  const long lines = read_lines(ends[0], std::atof(argv[1]));
  if (lines < 0)
    ::kill(-child, SIGKILL); // a process group that this program made
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  const std::string outcome = lines < 0             ? "timeout"
                              : WIFSIGNALED(status) ? "signal-" + std::to_string(WTERMSIG(status))
                                                    : "exit-" + std::to_string(WEXITSTATUS(status));
  std::printf("%s %ld %ld\n", outcome.c_str(), usage.ru_maxrss / 1024, std::max(lines, 0L));
  return 0;
}
