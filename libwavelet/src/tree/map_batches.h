#pragma once
// The maps of a set, a few at a time.

#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>
#include <wavelet/tree/map_set.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace haarlight::wavelet {

/// For errors of memory.
inline std::string map_text(int size) {
  return "a map of " + std::to_string(size) + " x " + std::to_string(size) + " pixels";
}

inline std::uint64_t map_bytes(int size) {
  return 3 * sizeof(float) * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
}

/// Calls work(place, slot) for every map, from several threads, and take(slot) for each in the
/// set's order, so that sums do not depend on the number of threads.
/// @param per_thread slots held at once for each thread
template <class Slot, class Work, class Take>
void for_each_map(const SetInfo& info, int per_thread, const Progress& progress, const Work& work,
                  const Take& take) {
  const int count = info.map_count();
  std::vector<Slot> batch(static_cast<std::size_t>(std::min(count, per_thread * thread_count())));
  for (int begin = 0; begin < count; begin += static_cast<int>(batch.size())) {
    const int filled = std::min(static_cast<int>(batch.size()), count - begin);
    parallel_for(static_cast<std::size_t>(filled), [&](std::size_t i) {
      const int index = begin + static_cast<int>(i);
      with_memory_for(map_text(info.size), map_bytes(info.size), [&] {
        work(MapPlace{index % info.columns, index / info.columns}, batch[i]);
      });
    });
    for (int i = 0; i < filled; ++i)
      take(batch[static_cast<std::size_t>(i)]);
    if (progress)
      progress(begin + filled, count);
  }
}

} // namespace haarlight::wavelet
