// Scene files: the JSON alone, the files it names are not opened.
#include "fuzz_target.h"

#include <renderer/scene/scene.h>

using namespace haarlight;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzzing::MemoryFile file;
  file.assign(fuzzing::bytes_of(data, size));
  fuzzing::read_or_refuse([&] { renderer::load_scene(file.path()); });
  return 0;
}
