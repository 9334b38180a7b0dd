// Scene files: the JSON alone, the files it names are not opened.
#include "fuzz_target.h"

#include <renderer/scene/scene.h>

using namespace haarlight;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzzing::read_file(data, size,
                            [](const std::string& path) { renderer::load_scene(path); });
}
