// Transfer files: what haarrelight apply reads before it opens a scene's own files.
#include "fuzz_target.h"
#include "haar_mutator.h"
#include "walk_trees.h"

#include <renderer/transfer/relight.h>

#include <algorithm>

using namespace haarlight;

namespace {

/// The scene that a transfer names, whatever hash it gives.
renderer::SceneDescription scene_of(const renderer::Transfer& transfer) {
  renderer::SceneDescription scene;
  scene.path = "scene.json";
  scene.hash = transfer.provenance().get("scene_hash");
  scene.materials.resize(1);
  scene.materials[0].name = "grey";
  scene.objects.resize(2);
  scene.object_names = {"", "ball"};
  return scene;
}

} // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return fuzzing::mutate_either(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzzing::read_file(data, size, [](const std::string& path) {
    const renderer::Transfer transfer(path);
    for (const wavelet::TreeView& tree :
         transfer.trees().first(std::min<std::size_t>(transfer.trees().size(), 64)))
      fuzzing::walk(tree);
    transfer.variation(scene_of(transfer));
  });
}
