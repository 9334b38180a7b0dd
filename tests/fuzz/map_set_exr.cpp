// EXR files as map sets and as pictures.
#include "fuzz_target.h"

#include <image/image_exr.h>
#include <image/map_set_exr.h>

#include <algorithm>

using namespace haarlight;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzzing::read_file(data, size, [](const std::string& path) {
    const image::ExrMapSource source(path);
    for (int row = 0; row < std::min(source.info().rows, 4); ++row)
      for (int column = 0; column < std::min(source.info().columns, 4); ++column)
        source.make(column, row);
  });
  return fuzzing::read_file(data, size, [](const std::string& path) { image::read_exr(path); });
}
