#pragma once
// Files for the tests of the probe library: a folder of their own, and the real probes where
// present.

#include <wavelet/base/error.h>

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <stdlib.h>

namespace haarlight::testing {

/// A folder that lives as long as the test.
class ProbeFolder {
public:
  ProbeFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "haarlight.XXXXXX").string();
    m_path = ::mkdtemp(name.data());
  }
  ~ProbeFolder() { std::filesystem::remove_all(m_path); }
  ProbeFolder(const ProbeFolder&) = delete;
  ProbeFolder& operator=(const ProbeFolder&) = delete;

  std::string path(const std::string& name) const { return (m_path / name).string(); }

  /// Writes a file of these bytes and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

private:
  std::filesystem::path m_path;
};

inline std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The path of a captured probe, which must exist.
inline std::string real_probe(const std::string& name) {
  const char* folder = std::getenv("HAARLIGHT_DATA");
  const std::filesystem::path data(folder != nullptr ? folder : HAARLIGHT_SHARED_DATA);
  const auto path = data / "probes" / name;
  INFO(path);
  REQUIRE(std::filesystem::exists(path));
  return path.string();
}

/// What an Error said, or an empty text if none was thrown.
template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

} // namespace haarlight::testing
