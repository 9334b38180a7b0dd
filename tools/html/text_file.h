#pragma once
// Small files written whole or not at all.

#include <wavelet/file/output_file.h>

#include <string>

namespace haarlight::html {

/// @throws Error(Output)
inline void write_text(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

} // namespace haarlight::html
