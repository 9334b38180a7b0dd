#include "probe_files.h"

#include "file/external_reader.h"

#include <probe/read_probe.h>

#include <chrono>
#include <csignal>

#include <fcntl.h>
#include <png.h>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::ProbeFolder;

namespace {

/// A file whose decoded pixels do not fit into the pipe, so that the reader waits for this process.
std::string write_large_png(const std::string& path) {
  constexpr png_uint_32 side = 1024;
  std::vector<png_byte> samples(std::size_t{side} * side, 100);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = side;
  image.height = side;
  image.format = PNG_FORMAT_GRAY;
  ::png_image_write_to_file(&image, path.c_str(), 0, samples.data(), 0, nullptr);
  return path;
}

/// The only child of this process; nothing if the system does not list children.
std::optional<pid_t> only_child() {
  const std::string self = std::to_string(::getpid());
  std::ifstream list("/proc/self/task/" + self + "/children");
  pid_t pid = 0;
  if (!(list >> pid))
    return std::nullopt;
  return pid;
}

const std::vector<std::string> arguments = {"PNG", "", "", "10"};

} // namespace

TEST_CASE("The death of the reader is reported as a phrase", "[reader_process]") {
  const ProbeFolder folder;
  const std::string path = write_large_png(folder.path("a.png"));
  for (const auto& [signal, phrase] :
       {std::pair(SIGSEGV, "the reader crashed (SIGSEGV)"), std::pair(SIGFPE, "(SIGFPE)"),
        std::pair(SIGXCPU, "too much CPU time")}) {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    ReaderProcess reader(file.value, arguments, std::chrono::seconds(20));
    ReaderHeader header{};
    REQUIRE(reader.read(&header, sizeof header));
    CHECK(header.magic == reader_magic);
    CHECK(header.width == 1024);
    const auto child = only_child();
    if (!child) {
      WARN("skipped: the system does not list children");
      return;
    }
    ::kill(*child, signal);
    char byte = 0;
    while (reader.read(&byte, 1)) {
    }
    CHECK_THAT(reader.finish(), Catch::Contains(phrase));
  }
}

TEST_CASE("A reader that takes too long or sends too much is ended", "[reader_process]") {
  const ProbeFolder folder;
  const std::string path = write_large_png(folder.path("a.png"));
  {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    ReaderProcess reader(file.value, arguments, std::chrono::seconds(0));
    char byte = 0;
    CHECK_FALSE(reader.read(&byte, 1));
    CHECK_THAT(reader.finish(), Catch::Contains("longer than 0 s"));
  }
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  ReaderProcess reader(file.value, arguments, std::chrono::seconds(20));
  CHECK_THAT(reader.finish(), Catch::Contains("too much"));
}
