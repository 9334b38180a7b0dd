// Packed .haar files, unpacked and used.
#include "fuzz_target.h"
#include "haar_mutator.h"
#include "walk_trees.h"

#include <wavelet/file/tree_set.h>

using namespace haarlight;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return fuzzing::mutate_packed(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzzing::read_file(data, size, [](const std::string& path) {
    fuzzing::walk(wavelet::open_tree_set(path, wavelet::Check::WhenUsed));
  });
}
