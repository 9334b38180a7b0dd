#pragma once
// The line between this library and the module that links OpenImageIO. Linking it costs a process
// about 0.3 s and 130 MB before main() begins, so it is loaded only when such a picture is read.

#include <probe/image.h>

#include <string>

namespace haarlight::probe {

/// What the module hands over: pixels as they are in the file, or a message of one line.
struct ForeignImage {
  Image image;
  std::string note;  ///< what was done to the values; empty if nothing
  std::string error; ///< empty if all went well
};

/// The function the module exports.
using ReadForeign = void (*)(const std::string& path, ForeignImage& result);
inline constexpr const char* read_foreign_name = "haarlight_read_foreign_image";

/// Reads a picture through the module, loading it if this is the first.
/// @throws Error(Input)
ForeignImage read_foreign_image(const std::string& path);

} // namespace haarlight::probe
