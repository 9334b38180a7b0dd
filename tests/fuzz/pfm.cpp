// Portable float maps.
#include "fuzz_target.h"

#include <file/image_formats.h>

using namespace haarlight;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzzing::bytes_of(data, size);
  fuzzing::read_or_refuse([&] {
    std::vector<std::string> notes;
    if (probe::detect_format(bytes, "probe.pfm") == probe::ImageFormat::Pfm)
      probe::read_pfm(bytes, "probe.pfm", notes);
  });
  return 0;
}
