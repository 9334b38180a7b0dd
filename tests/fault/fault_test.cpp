// Faults of the operating system and signals at random times: a program must end with an exit code
// and one line, and its outputs must be complete or as they were before.
// Usage: fault_test PROGRAM_FOLDER SHIM faults|signals|limits [CASE…]     (default: all cases)
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// A command that writes files into the current folder; its inputs lie in "../in".
struct Case {
  std::string name;
  Strings command;
  Strings outputs;
  /// Outputs hold durations: they are complete if they start and end as without a fault.
  bool timed = false;
  /// Complete files that a failed run may leave here, for the next one.
  std::string cache = "";
  /// Runs in a graphics library, whose own calls of mmap, open and pthread_create are not tested.
  bool graphics = false;
};

// clang-format off
const std::vector<Case> cases = {
    {"probesynth", {"probesynth", "--scene", "studio", "--size", "32", "-o", "out.hdr"}, {"out.hdr"}},
    {"probe2maps-exr", {"probe2maps", "../in/studio.hdr", "--size", "32", "-o", "out.exr"}, {"out.exr"}},
    {"probe2maps-haar", {"probe2maps", "../in/studio.hdr", "--size", "32", "-o", "out.haar"}, {"out.haar"}},
    {"brdf2maps", {"brdf2maps", "../in/ggx.binary", "--size", "16", "--theta", "2", "--conservation-tolerance", "1", "-o", "out.haar"}, {"out.haar"}},
    {"maps2haar", {"maps2haar", "../in/light.exr", "-o", "out.haar"}, {"out.haar"}},
    {"maps2haar-pack", {"maps2haar", "../in/light.haar", "--pack", "-o", "out.haar"}, {"out.haar"}},
    {"maps2haar-unpack", {"maps2haar", "../in/packed.haar", "--unpack", "-o", "out.haar"}, {"out.haar"}},
    {"haarinfo", {"haarinfo", "../in/packed.haar", "--html", "out.html"}, {"out.html"}},
    {"haardiff", {"haardiff", "../in/light.haar", "../in/light.exr", "--image", "out.png"}, {"out.png"}},
    {"haarprod", {"haarprod", "../in/light.haar", "../in/light.haar", "-o", "out.haar"}, {"out.haar"}},
    {"haarrender", {"haarrender", "../in/scene.json", "--spp", "1", "-o", "out.exr", "--image", "out.png"}, {"out.exr", "out.png"}},
    {"haarrelight-build", {"haarrelight", "build", "../in/scene.json", "--vary", "light", "--tolerance", "0.3", "--resolution", "8", "-o", "out.haar"}, {"out.haar"}},
    {"haarrelight-apply", {"haarrelight", "apply", "../in/transfer.haar", "-o", "out.exr"}, {"out.exr"}},
    {"haarsheet", {"haarsheet", "../in/picture.exr", "../in/picture.exr", "-o", "out.png"}, {"out.png"}},
    {"brdfsynth", {"brdfsynth", "--model", "ggx", "--diffuse", "0.2,0.1,0.1", "-o", "out.binary"}, {"out.binary"}},
    {"haarrelight-sweep", {"haarrelight", "sweep", "../in/transfer.haar", "--frames", "2", "-o", "out.png"}, {"out.png", "out-0000.png", "out-0001.png"}},
    {"haarbench", {"haarbench", "--brdf", "../in/ggx.binary", "--probe", "../in/studio.hdr", "--samplers", "light", "--size", "4x4", "--seeds", "2", "--spp", "1", "--reference-spp", "16", "--brdf-size", "8", "--theta", "2", "--probe-size", "8", "-o", "out"},
     {"out/results.json", "out/results.csv", "out/report.html"}, true, "out/cache/"},
    {"haarview", {"haarview", "../in/transfer.haar", "--image", "out.exr"}, {"out.exr"}, false, "", true},
    {"haarview-export", {"haarview", "../in/lobe.haar", "--size", "8x8", "--html", "out.html"}, {"out.html"}, false, "", true},
};

const std::vector<Strings> preparation = {
    {"brdfsynth", "--model", "ggx", "--diffuse", "0.2,0.1,0.1", "--roughness", "0.4", "-q", "-o", "ggx.binary"},
    {"probesynth", "--scene", "studio", "--size", "32", "-q", "-o", "studio.hdr"},
    {"probe2maps", "studio.hdr", "-q", "--size", "32", "-o", "light.exr"},
    {"maps2haar", "light.exr", "-q", "-o", "light.haar"},
    {"maps2haar", "light.haar", "-q", "--pack", "-o", "packed.haar"},
    {"brdf2maps", "ggx.binary", "-q", "--size", "16", "--theta", "2", "--conservation-tolerance", "1", "-o", "lobe.haar"},
    {"haarrender", "scene.json", "-q", "--spp", "1", "-o", "picture.exr"},
    {"haarrelight", "build", "scene.json", "-q", "--vary", "light", "--tolerance", "0.3", "--resolution", "8", "-o", "transfer.haar"},
};

const char* const scene = R"({"film": {"width": 32, "height": 32},
 "camera": {"type": "perspective", "from": [0, 0, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
 "light": {"haar": "light.haar"}, "materials": {"m": {"lambert": [0.5, 0.5, 0.5]}},
 "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}]})";
// clang-format on

/// What is arranged for one run.
struct Setup {
  std::map<std::string, std::string> environment;
  long file_size_limit = -1; ///< bytes; −1: none
  bool must_fail = false;    ///< a program that meets the fault may not succeed
  int signal = 0;            ///< sent after `delay` seconds
  double delay = 0;
};

struct Outcome {
  int status = 0;
  bool timed_out = false;
  double seconds = 0;
  std::string complaint; ///< stderr
};

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

double now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Runner {
public:
  /// @param chosen names of cases; empty for all
  Runner(fs::path programs, fs::path shim, Strings chosen)
      : m_programs(std::move(programs)), m_shim(shim), m_chosen(std::move(chosen)) {
    std::string name = (fs::temp_directory_path() / "fault.XXXXXX").string();
    m_root = ::mkdtemp(name.data());
    for (const char* folder : {"in", "work", "tmp"})
      fs::create_directory(m_root / folder);
    write_file(m_root / "in/scene.json", scene);
    for (const Strings& command : preparation)
      if (run(command, "in", {}).status != 0) {
        std::printf("FAILED: preparation by %s\n", command[0].c_str());
        ++m_failures;
      }
  }
  ~Runner() { fs::remove_all(m_root); }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  int failures() const { return m_failures; }
  int runs() const { return m_runs; }

  /// Remembers the outputs of an undisturbed run.
  /// @return its duration; nothing if the case was not chosen, or the program was not built or
  ///         cannot draw on this machine
  std::optional<double> remember(const Case& c) {
    clear();
    if (!m_chosen.empty() && std::find(m_chosen.begin(), m_chosen.end(), c.name) == m_chosen.end())
      return std::nullopt;
    if (c.graphics && !fs::exists(m_programs / c.command[0])) {
      std::printf("SKIPPED: %s: was not built\n", c.name.c_str());
      return std::nullopt;
    }
    const Outcome outcome = run(c.command, "work", {});
    if (c.graphics && outcome.complaint.rfind(c.command[0] + ": EGL: ", 0) == 0) {
      std::printf("SKIPPED: %s", outcome.complaint.c_str());
      return std::nullopt;
    }
    m_wanted.clear();
    for (const std::string& output : c.outputs)
      m_wanted[output] = read_file(m_root / "work" / output);
    if (outcome.status != 0)
      fail(c, "undisturbed", outcome, "does not succeed");
    return outcome.seconds;
  }

  /// Runs a case with old outputs in place or without, and checks what must hold.
  /// @return whether the fault was injected
  bool disturb(const Case& c, const std::string& what, Setup setup, bool old_outputs) {
    clear();
    const std::string old = "an output of an earlier run\n";
    for (const std::string& output : c.outputs)
      if (old_outputs) {
        fs::create_directories((m_root / "work" / output).parent_path());
        write_file(m_root / "work" / output, old);
      }
    setup.environment["FAULT_MARK"] = (m_root / "mark").string();
    const Outcome outcome = run(c.command, "work", setup);
    ++m_runs;
    check_end(c, what, setup, outcome);
    const bool done = outcome.status == 0;
    const auto intact = [&](const std::string& output) {
      const fs::path path = m_root / "work" / output;
      if (!fs::exists(path))
        return !done && !old_outputs;
      const std::string bytes = read_file(path);
      return is_complete(c, output, bytes) || (!done && old_outputs && bytes == old);
    };
    for (const std::string& output : c.outputs)
      if (!intact(output))
        fail(c, what, outcome, output + " is neither complete nor as before");
    if (setup.signal == SIGKILL)
      check_recovery(c, what);
    check_leftovers(c, what, outcome);
    const bool injected = fs::exists(m_root / "mark");
    if (injected && done && setup.must_fail)
      fail(c, what, outcome, "ignores the failure");
    return injected;
  }

private:
  bool is_complete(const Case& c, const std::string& output, const std::string& bytes) {
    const std::string& wanted = m_wanted[output];
    if (!c.timed)
      return bytes == wanted;
    // Axes and thus the number of lines go with the durations; the end of a file does not.
    const auto last_line = [](const std::string& text) {
      return text.substr(text.find_last_of('\n', text.size() - 2) + 1);
    };
    return bytes.size() > 2 && bytes.substr(0, 8) == wanted.substr(0, 8) &&
           (output.ends_with(".csv")
                ? std::ranges::count(bytes, '\n') == std::ranges::count(wanted, '\n')
                : last_line(bytes) == last_line(wanted));
  }

  void clear() const {
    for (const char* folder : {"work", "tmp"})
      for (const auto& entry : fs::directory_iterator(m_root / folder))
        fs::remove_all(entry.path());
    fs::remove(m_root / "mark");
  }

  void check_end(const Case& c, const std::string& what, const Setup& setup,
                 const Outcome& outcome) {
    if (outcome.timed_out)
      return fail(c, what, outcome, "hangs");
    if (setup.signal != 0) {
      const bool by_signal =
          (WIFSIGNALED(outcome.status) && WTERMSIG(outcome.status) == setup.signal) ||
          (WIFEXITED(outcome.status) &&
           (WEXITSTATUS(outcome.status) == 128 + setup.signal || WEXITSTATUS(outcome.status) == 0));
      if (!by_signal)
        fail(c, what, outcome, "ends in another way than by the signal");
      return;
    }
    if (!WIFEXITED(outcome.status))
      return fail(c, what, outcome, "ends by a signal");
    const int code = WEXITSTATUS(outcome.status);
    if (code == 0)
      return;
    if (code < 3 || code > 5)
      fail(c, what, outcome, "exit code is not 0, 3, 4 or 5");
    if (std::count(outcome.complaint.begin(), outcome.complaint.end(), '\n') != 1 ||
        outcome.complaint.rfind(c.command[0], 0) != 0)
      fail(c, what, outcome, "stderr is not one line that begins with the program's name");
  }

  /// What a killed run leaves behind goes with the next run of the same output.
  void check_recovery(const Case& c, const std::string& what) {
    const Outcome outcome = run(c.command, "work", {});
    if (outcome.status != 0)
      fail(c, what, outcome, "cannot be run again");
    for (const std::string& output : c.outputs)
      if (!is_complete(c, output, read_file(m_root / "work" / output)))
        fail(c, what, outcome, output + " is wrong after a second run");
  }

  void check_leftovers(const Case& c, const std::string& what, const Outcome& outcome) {
    for (const char* folder : {"work", "tmp"})
      for (const auto& entry : fs::recursive_directory_iterator(m_root / folder)) {
        const std::string name = fs::relative(entry.path(), m_root / folder).string();
        if (!may_remain(c, name, entry.is_directory()))
          fail(c, what, outcome, "leaves " + name);
      }
  }

  /// Outputs, their folders, and files of a cache that have their names.
  static bool may_remain(const Case& c, const std::string& name, bool is_folder) {
    if (is_folder)
      return std::any_of(
                 c.outputs.begin(), c.outputs.end(),
                 [&](const std::string& output) { return output.rfind(name + "/", 0) == 0; }) ||
             name + "/" == c.cache;
    const bool cached = !c.cache.empty() && name.rfind(c.cache, 0) == 0;
    return (cached && name[c.cache.size()] != '.') ||
           std::find(c.outputs.begin(), c.outputs.end(), name) != c.outputs.end();
  }

  void fail(const Case& c, const std::string& what, const Outcome& outcome,
            const std::string& message) {
    ++m_failures;
    std::printf("FAILED: %s, %s: %s (status %x): %s\n", c.name.c_str(), what.c_str(),
                message.c_str(), static_cast<unsigned>(outcome.status),
                outcome.complaint.substr(0, 300).c_str());
  }

  [[noreturn]] void start(const Strings& command, const char* folder, const Setup& setup,
                          int errors) const {
    if (::chdir((m_root / folder).c_str()) != 0)
      std::_Exit(126);
    ::dup2(::open("/dev/null", O_WRONLY), 1);
    ::dup2(errors, 2);
    ::setenv("TMPDIR", (m_root / "tmp").c_str(), 1);
    for (const auto& [name, value] : setup.environment)
      ::setenv(name.c_str(), value.c_str(), 1);
    if (setup.environment.count("FAULT_CALL") > 0)
      ::setenv("LD_PRELOAD", m_shim.c_str(), 1);
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    if (setup.file_size_limit >= 0) {
      const auto limit = static_cast<rlim_t>(setup.file_size_limit);
      const rlimit size{limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &size);
    }
    const std::string program = (m_programs / command[0]).string();
    std::vector<char*> arguments;
    for (const std::string& word : command)
      arguments.push_back(const_cast<char*>(word.c_str()));
    char quiet[] = "-q";
    arguments.push_back(quiet);
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    std::_Exit(127);
  }

  Outcome run(const Strings& command, const char* folder, const Setup& setup) const {
    int errors[2]; // a pipe: a file would be limited in size, too
    if (::pipe2(errors, O_CLOEXEC | O_NONBLOCK) != 0)
      std::abort();
    const double begin = now();
    const pid_t child = ::fork();
    if (child == 0)
      start(command, folder, setup, errors[1]);
    Outcome outcome;
    bool sent = setup.signal == 0;
    while (::waitpid(child, &outcome.status, WNOHANG) == 0) {
      const double passed = now() - begin;
      if (!sent && passed >= setup.delay) {
        ::kill(child, setup.signal);
        sent = true;
      }
      if (passed > 20 && !outcome.timed_out) {
        ::kill(child, SIGKILL);
        outcome.timed_out = true;
      }
      ::usleep(200);
    }
    outcome.seconds = now() - begin;
    char text[4096];
    const ssize_t size = ::read(errors[0], text, sizeof text);
    outcome.complaint.assign(text, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    ::close(errors[0]);
    ::close(errors[1]);
    return outcome;
  }

  fs::path m_programs;
  fs::path m_shim;
  Strings m_chosen;
  fs::path m_root;
  std::map<std::string, std::string> m_wanted;
  int m_failures = 0;
  int m_runs = 0;
};

/// Every call of every function fails once, up to a number of calls.
void inject_faults(Runner& runner) {
  struct Call {
    const char* name;
    int error;
    int most;               ///< calls that are tried
    bool must_fail = false; ///< no program may ignore the failure
    bool library = false;   ///< graphics libraries call it
  };
  const Call calls[] = {{"write", ENOSPC, 6},
                        {"pwrite", ENOSPC, 12, true},
                        {"pwrite", EINTR, 2},
                        {"fsync", EIO, 4, true},
                        {"rename", EACCES, 4, true},
                        {"linkat", EACCES, 4, true},
                        {"ftruncate", EIO, 4},
                        {"mmap", ENOMEM, 6, false, true},
                        {"open", EMFILE, 8, false, true},
                        {"mkostemp", EACCES, 3},
                        {"pthread_create", EAGAIN, 3, false, true}};
  std::map<std::string, int> injected;
  for (const Case& c : cases) {
    if (!runner.remember(c))
      continue;
    for (const Call& call : calls)
      for (int k = 1; k <= call.most && !(c.graphics && call.library); ++k) {
        Setup setup;
        setup.environment = {{"FAULT_CALL", call.name},
                             {"FAULT_INDEX", std::to_string(k)},
                             {"FAULT_ERROR", std::to_string(call.error)}};
        setup.must_fail = call.must_fail && !c.graphics;
        const std::string what = std::string(call.name) + " " + std::to_string(k) + " fails by " +
                                 std::strerror(call.error);
        if (!runner.disturb(c, what, setup, k % 2 == 0))
          break;
        ++injected[call.name];
      }
  }
  for (const auto& [name, count] : injected)
    std::printf("%s: %d faults\n", name.c_str(), count);
}

void send_signals(Runner& runner) {
  std::mt19937 random(1);
  for (const Case& c : cases) {
    const std::optional<double> duration = runner.remember(c);
    if (!duration)
      continue;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGKILL})
      for (int i = 0; i < 4; ++i) {
        Setup setup;
        setup.signal = signal;
        setup.delay = 1.1 * *duration * std::uniform_real_distribution<double>(0, 1)(random);
        runner.disturb(c, "signal " + std::to_string(signal), setup, i % 2 == 0);
      }
  }
}

/// Files cannot grow beyond a size, as on a full disk.
void limit_sizes(Runner& runner) {
  for (const Case& c : cases) {
    if (!runner.remember(c))
      continue;
    for (const long bytes : {0L, 1L, 100L, 400L}) {
      Setup setup;
      setup.file_size_limit = bytes;
      runner.disturb(c, "files of " + std::to_string(bytes) + " bytes", setup, bytes % 2 == 0);
    }
  }
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fputs("usage: fault_test PROGRAM_FOLDER SHIM faults|signals|limits [CASE…]\n", stderr);
    return 2;
  }
  Runner runner(fs::absolute(argv[1]), fs::absolute(argv[2]), Strings(argv + 4, argv + argc));
  const std::string mode = argv[3];
  if (mode == "faults")
    inject_faults(runner);
  else if (mode == "signals")
    send_signals(runner);
  else
    limit_sizes(runner);
  std::printf("%d runs, %d failures\n", runner.runs(), runner.failures());
  return runner.failures() == 0 && runner.runs() > 0 ? 0 : 1;
}
