#pragma once
// What the reader program sends to the library that started it, on its standard output: a header,
// a text, and if the image was read, its pixels as floats. The receiver trusts none of it.
//
// Arguments of the program: format name, layer, part (empty = not chosen), soft limit of CPU
// seconds. Its standard input is the file.

#include <array>
#include <cstdint>

namespace haarlight::probe {

struct ReaderHeader {
  std::array<char, 8> magic;
  std::uint32_t failed;     ///< 1: the text is the error message and nothing follows; 0: read
  std::uint32_t text_bytes; ///< at most max_reader_text; notes end with a line feed each
  std::int32_t width;
  std::int32_t height;
};
static_assert(sizeof(ReaderHeader) == 24);

inline constexpr std::array<char, 8> reader_magic = {'h', 'a', 'a', 'r', 'i', 'm', 'g', '1'};
inline constexpr std::uint32_t max_reader_text = 16384;

} // namespace haarlight::probe
