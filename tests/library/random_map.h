#pragma once
// Random maps that look like what the toolkit stores: smooth parts, noise, and a few bright pixels.

#include <wavelet/tree/map_set.h>

#include <random>

inline haarlight::wavelet::Map random_map(int size, unsigned seed, bool sparse = false) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  haarlight::wavelet::Map map(size);
  for (float& value : map.rgb)
    value = sparse ? 0.25F : uniform(generator);
  for (int i = 0; i < size; ++i) {
    const int x = static_cast<int>(uniform(generator) * static_cast<float>(size));
    const int y = static_cast<int>(uniform(generator) * static_cast<float>(size));
    map.set(x, y, haarlight::Rgb(50 * uniform(generator), 40 * uniform(generator), 30));
  }
  return map;
}
