#pragma once
// Scene files of tests, and what is said about them.

#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace haarlight::renderer {

inline const std::string plain_scene = R"({ "film": {"width": 256, "height": 128},
  "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
  "light": {"probe": "grace_probe.hdr", "haar": "grace.haar"},
  "materials": {"acrylic": {"brdf": "violet-acrylic.binary", "haar": "violet-acrylic.haar"},
                "floor": {"lambert": [0.5, 0.25, 1]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "acrylic"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor"}] })";

/// A scene file that is gone with the test.
class SceneOnDisk {
public:
  explicit SceneOnDisk(const std::string& text) {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "haarlight_scene_XXXXXX").string();
    m_folder = ::mkdtemp(pattern.data());
    write(text);
  }
  ~SceneOnDisk() { std::filesystem::remove_all(m_folder); }
  SceneOnDisk(const SceneOnDisk&) = delete;
  SceneOnDisk& operator=(const SceneOnDisk&) = delete;

  void write(const std::string& text) const {
    std::ofstream(path(), std::ios::binary | std::ios::trunc) << text;
  }
  std::string path() const { return m_folder + "/scene.json"; }
  const std::string& folder() const { return m_folder; }

private:
  std::string m_folder;
};

inline SceneDescription load(const std::string& text) {
  return load_scene(SceneOnDisk(text).path());
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}

/// What load_scene says after the file's name.
inline std::string complaint(const std::string& text) {
  const SceneOnDisk scene(text);
  try {
    load_scene(scene.path());
  } catch (const Error& error) {
    const std::string what = error.what();
    REQUIRE(error.kind() == ErrorKind::Input);
    REQUIRE(what.rfind(scene.path() + ": ", 0) == 0);
    REQUIRE(what.find('\n') == std::string::npos);
    return what.substr(scene.path().size() + 2);
  }
  return "loads";
}

inline std::string with_object(const std::string& object) {
  return replaced(plain_scene, R"({"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], )",
                  object + ", ");
}

inline ObjectDescription object(const std::string& text) {
  return load(with_object(text)).objects[1];
}

} // namespace haarlight::renderer
