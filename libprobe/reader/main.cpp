// haarlight_read_image: decodes the image file on its standard input and writes the pixels to its
// standard output (src/file/external_reader.h). Started by the library, not by users.

#include "decoder.h"

#include "file/image_formats.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string_view>

#include <csignal>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace haarlight::probe::reader {
namespace {

/// Memory besides the pixels: headers, tables of offsets, buffers.
constexpr std::uint64_t working_memory = std::uint64_t{40} << 20;

std::uint64_t virtual_memory() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lu", &pages) != 1)
      pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void set_soft_limit(__rlimit_resource resource, rlim_t value) {
  rlimit limit{};
  ::getrlimit(resource, &limit);
  limit.rlim_cur = std::min(value, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

/// No core dumps, a limit of time, and death with the parent.
void confine(rlim_t cpu_seconds) {
  set_soft_limit(RLIMIT_CORE, 0);
  set_soft_limit(RLIMIT_CPU, cpu_seconds);
  ::prctl(PR_SET_DUMPABLE, 0); // a core_pattern that names a program ignores RLIMIT_CORE
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
}

std::span<const std::byte> map_input() {
  struct stat status = {};
  if (::fstat(STDIN_FILENO, &status) != 0 || status.st_size < 1)
    throw DecodeError("cannot be read");
  const auto size = static_cast<std::size_t>(status.st_size);
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, STDIN_FILENO, 0);
  if (address == MAP_FAILED)
    throw DecodeError("cannot be mapped");
  return {static_cast<const std::byte*>(address), size};
}

DecodedImage read(const Task& task, std::string_view format) {
  if (format == format_name(ImageFormat::OpenExr))
    return read_exr(task);
  if (format == format_name(ImageFormat::Tiff))
    return read_tiff(task);
  if (format == format_name(ImageFormat::Png))
    return read_png(task);
  return read_jpeg(task);
}

void send(const void* bytes, std::size_t count) {
  const auto* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t sent = ::write(STDOUT_FILENO, from, count);
    if (sent < 0 && errno == EINTR)
      continue;
    if (sent <= 0)
      ::_exit(1);
    from += sent;
    count -= static_cast<std::size_t>(sent);
  }
}

void send_text(std::uint32_t failed, std::string text, int width = 0, int height = 0) {
  text.resize(std::min<std::size_t>(text.size(), max_reader_text));
  const ReaderHeader header{reader_magic, failed, static_cast<std::uint32_t>(text.size()), width,
                            height};
  send(&header, sizeof header);
  send(text.data(), text.size());
}

void send(const DecodedImage& picture) {
  std::string notes;
  for (const std::string& note : picture.notes)
    notes += note + '\n';
  send_text(0, notes, picture.image.width, picture.image.height);
  send(picture.image.rgb.data(), picture.image.rgb.size() * sizeof(float));
}

} // namespace

void allow_memory(std::uint64_t bytes) {
  set_soft_limit(RLIMIT_AS, virtual_memory() + working_memory + bytes);
}

} // namespace haarlight::probe::reader

int main(int argc, char** argv) {
  using namespace haarlight::probe::reader;
  if (argc != 5)
    return 2;
  confine(std::strtoul(argv[4], nullptr, 10));
  try {
    const Task task{map_input(), {argv[2], argv[3]}};
    allow_memory(0);
    send(read(task, argv[1]));
  } catch (const std::bad_alloc&) {
    send_text(1, "cannot be decoded: it takes more memory than its size accounts for");
  } catch (const DecodeError& error) {
    send_text(1, error.what());
  } catch (const std::exception& error) {
    send_text(1, "cannot be decoded: " + first_line(error.what()));
  }
  ::_exit(0); // destructors of a library that met a damaged file are not to be trusted
}
