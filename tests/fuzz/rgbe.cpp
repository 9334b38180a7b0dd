// Radiance RGBE pictures.
#include "fuzz_target.h"

#include <probe/rgbe.h>

using namespace haarlight;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzzing::bytes_of(data, size);
  fuzzing::read_or_refuse([&] {
    if (probe::is_rgbe(bytes))
      probe::read_rgbe(bytes, "probe.hdr");
  });
  return 0;
}
