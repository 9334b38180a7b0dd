#include <wavelet/base/error.h>

namespace haarlight {
namespace {

/// "-" stands for a standard stream.
std::string shown(const std::string& path, ErrorKind kind) {
  if (path != "-")
    return path;
  return kind == ErrorKind::Input ? "standard input" : "standard output";
}

std::string compose(const std::string& path, const std::string& message,
                    std::optional<std::uint64_t> offset) {
  std::string text = path.empty() ? "" : path + ": ";
  if (offset)
    text += "byte " + std::to_string(*offset) + ": ";
  return text + message;
}

} // namespace

Error::Error(ErrorKind kind, std::string path, const std::string& message,
             std::optional<std::uint64_t> offset)
    : std::runtime_error(compose(shown(path, kind), message, offset)), m_kind(kind),
      m_path(std::move(path)), m_offset(offset) {}

void throw_input_error(const std::string& path, const std::string& message,
                       std::optional<std::uint64_t> offset) {
  throw Error(ErrorKind::Input, path, message, offset);
}

void throw_output_error(const std::string& path, const std::string& message) {
  throw Error(ErrorKind::Output, path, message);
}

} // namespace haarlight
