#include "file/foreign_image.h"

#include "file/reader_process.h"
#include "file/reader_protocol.h"

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>

#include <fcntl.h>
#include <sys/stat.h>

namespace haarlight::probe {
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

[[noreturn]] void throw_undecodable(const std::string& path, PictureFormat format,
                                    const std::string& reason) {
  throw_input_error(path, std::string("this ") + format_name(format) +
                              " file cannot be decoded: " + reason);
}

/// What the reader sent; nothing if it ended before that was complete or sent anything else.
struct ReaderResult {
  bool complete = false;
  std::string error;
  ForeignImage image;
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

ForeignImage read_foreign_image(const std::string& path, PictureFormat format,
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
