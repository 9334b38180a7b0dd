#pragma once
// What the BRDF tests share: temporary files, random directions, and the real measurements.

#include "temporary_folder.h"

#include <brdf/measured_brdf.h>

#include <wavelet/base/geometry.h>

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <zstd.h>

namespace brdf_test {

inline std::string read_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The folder of measurements: $HAARLIGHT_DATA/brdf, or the one beside the source tree.
inline std::filesystem::path measurement_folder() {
  const char* set = std::getenv("HAARLIGHT_DATA");
  return std::filesystem::path(set != nullptr ? set : HAARLIGHT_SHARED_DATA) / "brdf";
}

/// Unpacks a measurement into `folder`. @return its path
inline std::string unpack_measurement(const std::string& name, const TemporaryFolder& folder) {
  const auto packed_path = measurement_folder() / (name + ".binary.zst");
  INFO(packed_path);
  REQUIRE(std::filesystem::exists(packed_path));
  const std::string packed = read_bytes(packed_path.string());
  std::string bytes(ZSTD_getFrameContentSize(packed.data(), packed.size()), '\0');
  REQUIRE(ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()) ==
          bytes.size());
  const std::string path = folder.file(name + ".binary");
  write_bytes(path, bytes);
  return path;
}

inline const std::vector<std::string> measurement_names = {
    "pink-felt",  "red-plastic",   "violet-acrylic", "red-metallic-paint",
    "gold-paint", "nickel-noise5", "chrome"};

/// Evenly over the upper hemisphere.
inline haarlight::Vec3 random_direction(std::mt19937& generator) {
  std::uniform_real_distribution<float> uniform(0, 1);
  const float z = std::max(uniform(generator), 1e-4F);
  const float phi = 2 * haarlight::pi * uniform(generator);
  const float r = std::sqrt(1 - z * z);
  return haarlight::Vec3(r * std::cos(phi), r * std::sin(phi), z).normalized();
}

/// A table of random positive values, with every `hole`-th cell invalid (none if 0).
inline haarlight::brdf::MerlTable random_table(unsigned seed, int hole = 0, int phi_bins = 180) {
  std::minstd_rand generator(seed);
  haarlight::brdf::MerlTable table(phi_bins);
  for (double& value : table.raw)
    value = 100 + static_cast<double>(generator() % 200);
  for (std::size_t i = 0; hole > 0 && i < table.plane_size(); i += static_cast<std::size_t>(hole))
    for (std::size_t c = 0; c < 3; ++c)
      table.raw[c * table.plane_size() + i] = -1;
  return table;
}

/// A table of one value of f_r in every cell and channel.
inline haarlight::brdf::MerlTable constant_table(double f) {
  haarlight::brdf::MerlTable table;
  for (std::size_t i = 0; i < table.raw.size(); ++i)
    table.raw[i] = f / haarlight::brdf::merl_scale[i / table.plane_size()];
  return table;
}

} // namespace brdf_test
