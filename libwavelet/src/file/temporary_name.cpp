#include <wavelet/file/temporary_name.h>

#include <wavelet/file/input_file.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <set>
#include <span>

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight {
namespace {

// What a signal handler may read: no memory that another thread could free.
struct Slot {
  std::atomic<bool> taken = false;
  std::atomic<bool> named = false;
  char path[PATH_MAX];
};

std::array<Slot, 32> slots; ///< far more than files are written at once
std::atomic<int> holds = 0;
std::atomic<bool> ending = false; ///< remove_temporaries() was called

constexpr std::size_t no_slot = slots.size();

void wait_milliseconds(long count) {
  const std::timespec time = {0, count * 1000000};
  ::nanosleep(&time, nullptr);
}

constexpr const char* prefix = ".haarlight-tmp.";

std::string read_word(const char* path) {
  std::ifstream file(path);
  std::string word;
  file >> word;
  return word;
}

/// The host's name, and 8 digits of its machine id, since names of hosts are not always unique.
std::string make_host_tag() {
  char name[65] = "";
  ::gethostname(name, sizeof name - 1);
  const std::string id = read_word("/etc/machine-id");
  return std::string(name) + "-" + hash_text(std::as_bytes(std::span(id))).substr(0, 8);
}

const std::string& host_tag() {
  static const std::string tag = make_host_tag();
  return tag;
}

/// True for `prefix HOST.PID.RANDOM` of this host.
bool is_of_this_host(std::string_view name) {
  const std::string start = prefix + host_tag() + ".";
  if (name.substr(0, start.size()) != start)
    return false;
  name.remove_prefix(start.size());
  const std::size_t dot = name.find_first_not_of("0123456789");
  return dot != 0 && dot != name.npos && name[dot] == '.' && name.size() == dot + 17 &&
         name.find_first_not_of("0123456789abcdef", dot + 1) == name.npos;
}

/// Of this user, and locked by nobody.
void remove_if_dead(int folder, const char* name, const std::string& path) {
  const int descriptor =
      ::openat(folder, name, O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0)
    return;
  struct stat status = {};
  if (::fstat(descriptor, &status) == 0 && status.st_uid == ::geteuid() &&
      ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    std::error_code ignored;
    if (S_ISREG(status.st_mode))
      ::unlinkat(folder, name, 0);
    else if (S_ISDIR(status.st_mode))
      std::filesystem::remove_all(path, ignored);
  }
  ::close(descriptor);
}

bool first_visit(const std::string& folder) {
  static std::mutex mutex;
  static std::set<std::string> visited;
  const std::lock_guard lock(mutex);
  return visited.insert(folder).second;
}

} // namespace

TemporaryName::TemporaryName(std::string path) : m_path(std::move(path)), m_slot(no_slot) {
  if (m_path.size() >= PATH_MAX)
    return; // no file can have this name
  for (std::size_t i = 0; i < slots.size() && m_slot == no_slot; ++i)
    if (!slots[i].taken.exchange(true)) {
      std::memcpy(slots[i].path, m_path.c_str(), m_path.size() + 1);
      slots[i].named = true;
      m_slot = i;
    }
}

TemporaryName::~TemporaryName() {
  if (m_path.empty())
    return;
  if (::unlink(m_path.c_str()) != 0 && errno == EISDIR)
    ::rmdir(m_path.c_str());
  release();
}

void TemporaryName::release() {
  m_path.clear();
  if (m_slot == no_slot)
    return;
  slots[m_slot].named = false;
  slots[m_slot].taken = false;
  m_slot = no_slot;
}

SignalHold::SignalHold() {
  sigset_t all;
  sigfillset(&all);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    sigdelset(&all, fault);
  ::pthread_sigmask(SIG_BLOCK, &all, &m_mask);
  ++holds;
  if (!ending)
    return;
  --holds;
  for (;;)
    wait_milliseconds(100); // another thread is ending the process
}

SignalHold::~SignalHold() {
  --holds;
  ::pthread_sigmask(SIG_SETMASK, &m_mask, nullptr);
}

void remove_temporaries() noexcept {
  ending = true;
  // A second at most: a network folder may hang, and the process shall still end.
  for (int i = 0; i < 1000 && holds > 0; ++i)
    wait_milliseconds(1);
  // Backwards: a folder takes its name before the files in it.
  for (std::size_t i = slots.size(); i-- > 0;)
    if (slots[i].named && ::unlink(slots[i].path) != 0 && errno == EISDIR)
      ::rmdir(slots[i].path);
}

std::string temporary_path(const std::string& folder) {
  static std::mutex mutex;
  static std::random_device random;
  std::uint64_t numbers[2];
  {
    const std::lock_guard lock(mutex);
    numbers[0] = random();
    numbers[1] = random();
  }
  return folder + "/" + prefix + host_tag() + "." + std::to_string(::getpid()) + "." +
         hash_text(std::as_bytes(std::span(numbers)));
}

void remove_leftovers(const std::string& folder) {
  DIR* const entries = first_visit(folder) ? ::opendir(folder.c_str()) : nullptr;
  if (entries == nullptr)
    return;
  while (const dirent* entry = ::readdir(entries))
    if (is_of_this_host(entry->d_name))
      remove_if_dead(::dirfd(entries), entry->d_name, folder + "/" + entry->d_name);
  ::closedir(entries);
}

} // namespace haarlight
