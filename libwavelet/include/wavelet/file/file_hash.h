#pragma once
// The hash that provenance knows a file by.

#include <string>

namespace haarlight {

/// hash_text() of all bytes of a file, read piece by piece so that large files do not fill the
/// memory. @throws Error(Input) if it cannot be read
std::string file_hash(const std::string& path);

} // namespace haarlight
