#include "file/external_reader.h"

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <poll.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>

namespace haarlight::probe {
namespace {

constexpr const char* reader_name = "haarlight_read_image";

/// Folder of the running program, with a slash at its end.
std::string program_folder() {
  char path[PATH_MAX];
  const ssize_t length = ::readlink("/proc/self/exe", path, sizeof path);
  const std::string name(path, length > 0 ? static_cast<std::size_t>(length) : 0);
  return name.substr(0, name.find_last_of('/') + 1);
}

/// The folders of the running program's library search path (its run path is among them).
std::vector<std::string> library_folders() {
  std::vector<std::string> folders;
  void* program = ::dlopen(nullptr, RTLD_NOW);
  if (program == nullptr)
    return folders;
  Dl_serinfo size{};
  if (::dlinfo(program, RTLD_DI_SERINFOSIZE, &size) == 0) {
    std::vector<Dl_serinfo> storage(size.dls_size / sizeof(Dl_serinfo) + 1);
    Dl_serinfo* info = storage.data();
    info->dls_size = size.dls_size;
    info->dls_cnt = size.dls_cnt;
    if (::dlinfo(program, RTLD_DI_SERINFO, info) == 0)
      for (unsigned i = 0; i < info->dls_cnt; ++i)
        folders.push_back(std::string(info->dls_serpath[i].dls_name) + '/');
  }
  ::dlclose(program);
  return folders;
}

/// Relative to the toolkit's own programs first, in the build tree and installed alike; then along
/// the run path, by which programs of other projects find it.
std::string find_reader() {
  std::vector<std::string> folders = library_folders();
  folders.insert(folders.begin(), program_folder() + HAARLIGHT_READER_FOLDER);
  for (const std::string& folder : folders)
    if (::access((folder + reader_name).c_str(), X_OK) == 0)
      return folder + reader_name;
  throw std::runtime_error(std::string("the program ") + reader_name +
                           ", which decodes image files, is not installed: none in " + folders[0]);
}

/// Attributes of the child: default signals, none blocked, whatever the parent has set.
class SpawnSettings {
public:
  SpawnSettings(int input, int output) {
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawnattr_init(&attributes);
    sigset_t all;
    sigset_t none;
    ::sigfillset(&all);
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigdefault(&attributes, &all);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnSettings() {
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&actions);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
};

std::string signal_phrase(int signal) {
  if (signal == SIGXCPU)
    return "it takes too much CPU time";
  const char* name = ::sigabbrev_np(signal);
  return "the reader crashed (" +
         (name != nullptr ? "SIG" + std::string(name) : "signal " + std::to_string(signal)) + ")";
}

} // namespace

ReaderProcess::ReaderProcess(int input, const std::vector<std::string>& arguments,
                             std::chrono::seconds wall_limit)
    : m_output(-1), m_deadline(Clock::now() + wall_limit), m_limit(wall_limit) {
  static const std::string program = find_reader();
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(std::string("no pipe to the image reader: ") + std::strerror(errno));
  m_output.value = ends[0];
  Descriptor child_end(ends[1]);
  constexpr int pipe_bytes = 1 << 20; // fewer switches between the two; the default is correct too
  ::fcntl(child_end.value, F_SETPIPE_SZ, pipe_bytes);
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  char* environment[] = {nullptr};
  const SpawnSettings settings(input, child_end.value);
  const int error = ::posix_spawn(&m_pid, program.c_str(), &settings.actions, &settings.attributes,
                                  argv.data(), environment);
  if (error != 0) {
    m_pid = -1;
    throw std::runtime_error("the image reader cannot be started: " +
                             std::string(std::strerror(error)));
  }
}

ReaderProcess::~ReaderProcess() {
  if (m_pid > 0) {
    m_timed_out = true; // do not wait for its output
    finish();
  }
}

bool ReaderProcess::read(void* bytes, std::size_t count) {
  auto* to = static_cast<char*>(bytes);
  while (count > 0) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(m_deadline - Clock::now()).count();
    pollfd ready = {m_output.value, POLLIN, 0};
    const int events =
        left > 0 ? ::poll(&ready, 1, static_cast<int>(std::min<long>(left, INT_MAX))) : 0;
    if (events < 0 && errno == EINTR)
      continue;
    if (events <= 0) {
      m_timed_out = true;
      return false;
    }
    const ssize_t got = ::read(m_output.value, to, count);
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      return false;
    to += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

std::string ReaderProcess::finish() {
  char extra = 0;
  const bool too_much = !m_timed_out && read(&extra, 1); // otherwise waits for the end of output
  if (m_timed_out || too_much)
    ::kill(m_pid, SIGKILL);
  m_output.close();
  int status = 0;
  while (::waitpid(m_pid, &status, 0) < 0 && errno == EINTR) {
  }
  m_pid = -1;
  if (m_timed_out)
    return "it takes longer than " + std::to_string(m_limit.count()) + " s";
  if (too_much)
    return "the reader sent too much";
  if (WIFSIGNALED(status))
    return signal_phrase(WTERMSIG(status));
  if (WEXITSTATUS(status) != 0)
    return "the reader ended with exit code " + std::to_string(WEXITSTATUS(status));
  return {};
}

namespace {

/// Seconds of CPU time that decoding may take: a limit for decoders that do not end, far above the
/// time of those that do.
std::uint64_t cpu_seconds(std::uint64_t file_bytes) { return 60 + 2 * (file_bytes >> 20); }

/// Waiting time per second of CPU time that is allowed: other processes run too.
constexpr std::uint64_t wall_factor = 5;

/// The text with everything unprintable replaced: names come from the file.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      c = '?';
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(printable(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return lines;
}

[[noreturn]] void throw_undecodable(const std::string& path, ImageFormat format,
                                    const std::string& reason) {
  throw_input_error(path, std::string("this ") + format_name(format) +
                              " file cannot be decoded: " + reason);
}

/// The output of the reader; not complete if it ended early or sent anything else.
struct ReaderResult {
  bool complete = false;
  std::string error;
  DecodedImage image;
};

ReaderResult receive(ReaderProcess& reader) {
  ReaderResult result;
  ReaderHeader header{};
  if (!reader.read(&header, sizeof header) || header.magic != reader_magic ||
      header.text_bytes > max_reader_text)
    return result;
  std::string text(header.text_bytes, '\0');
  if (!reader.read(text.data(), text.size()))
    return result;
  if (header.failed != 0) {
    result.error = printable(text);
    result.complete = true;
    return result;
  }
  if (header.width < 1 || header.height < 1 ||
      static_cast<std::size_t>(header.width) > max_pixels / static_cast<std::size_t>(header.height))
    return result;
  result.image.notes = lines_of(text);
  result.image.image = Image(header.width, header.height);
  std::vector<float>& rgb = result.image.image.rgb;
  result.complete = reader.read(rgb.data(), rgb.size() * sizeof(float));
  return result;
}

} // namespace

DecodedImage read_with_reader(const std::string& path, ImageFormat format,
                              const ImageChoice& choice) {
  const Descriptor file(::open(openable_path(path).c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat status = {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0)
    throw_input_error(path, "cannot be opened again");
  const std::uint64_t seconds = cpu_seconds(static_cast<std::uint64_t>(status.st_size));
  ReaderProcess reader(file.value,
                       {format_name(format), choice.layer, choice.part, std::to_string(seconds)},
                       std::chrono::seconds(wall_factor * seconds));
  ReaderResult result = receive(reader);
  const std::string death = reader.finish();
  if (!death.empty() && !(result.complete && !result.error.empty()))
    throw_undecodable(path, format, death);
  if (!result.complete)
    throw_undecodable(path, format, "the reader sent no valid result");
  if (!result.error.empty())
    throw_input_error(path, result.error);
  return std::move(result.image);
}

} // namespace haarlight::probe
