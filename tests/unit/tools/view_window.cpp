// What haarview's window rests on: the camera's way round, and files that change.
#include <view/window_orbit.h>
#include <view/window_watch.h>

#include <wavelet/base/error.h>

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <sys/wait.h>
#include <unistd.h>

using namespace haarlight;
using namespace haarlight::view;

namespace {

namespace fs = std::filesystem;

renderer::CameraDescription camera(const Vec3& from) {
  renderer::CameraDescription result;
  result.from = from;
  result.to = Vec3(1, 0, 0);
  return result;
}

bool near(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-5F; }

/// A folder that goes with the test.
struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "haarview_test.XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return (path / name).string();
  }
};

} // namespace

TEST_CASE("a camera that is not moved stays where it was", "[view]") {
  const auto start = camera({3, 1, -2});
  CHECK(near(Orbit(start).camera().from, start.from));
  Orbit orbit(start);
  orbit.turn(100, 0);
  orbit.turn(260, 0);
  CHECK(near(orbit.camera().from, start.from));
}

TEST_CASE("a camera goes to the right and upwards about what it looks at", "[view]") {
  Orbit orbit(camera({1, 0, 2}));
  orbit.turn(90, 0);
  CHECK(near(orbit.camera().from, {3, 0, 0}));
  orbit.turn(0, 30);
  CHECK(near(orbit.camera().from, {1 + std::sqrt(3.0F), 1, 0}));
  orbit.turn(0, 1000);
  CHECK(orbit.camera().from.y() < 2);
  CHECK(orbit.camera().from.y() > 1.999F);
}

TEST_CASE("a camera shows things larger from nearer, or in a lower picture", "[view]") {
  auto start = camera({1, 0, 2});
  Orbit perspective(start);
  perspective.enlarge(4);
  CHECK(near(perspective.camera().from, {1, 0, 0.5F}));
  start.projection = renderer::CameraProjection::Orthographic;
  start.height = 3;
  Orbit orthographic(start);
  orthographic.enlarge(4);
  CHECK(near(orthographic.camera().from, start.from));
  CHECK(orthographic.camera().height == Approx(0.75));
}

TEST_CASE("a changed file is told of once, when it has settled", "[view]") {
  const Folder folder;
  const std::string path = folder.write("file", "one");
  FileWatch watch({path});
  CHECK_FALSE(watch.changed());
  folder.write("file", "another");
  CHECK_FALSE(watch.changed()); // it may still be being written
  CHECK(watch.changed());
  CHECK_FALSE(watch.changed());
  fs::remove(path);
  CHECK_FALSE(watch.changed());
  CHECK(watch.changed());
}

TEST_CASE("a copy of a file has its bytes and name, and goes with its object", "[view]") {
  const Folder folder;
  std::string path = folder.write("trees.haar", "bytes");
  const std::string original = path;
  {
    FileCopies copies;
    copies.take(path);
    CHECK(path != original);
    CHECK(fs::path(path).filename() == "trees.haar");
    CHECK(fs::file_size(path) == 5);
    const Error told = copies.told_of_originals(Error(ErrorKind::Input, path, "is broken", 3));
    CHECK(told.path() == original);
    CHECK(std::string(told.what()) == original + ": byte 3: is broken");
  }
  CHECK_FALSE(fs::exists(path));
  std::string missing = (folder.path / "missing").string();
  CHECK_THROWS_AS(FileCopies().take(missing), Error);
}

TEST_CASE("copies of files are removed when a signal ends the process", "[view]") {
  const Folder folder;
  std::string path = folder.write("trees.haar", "bytes");
  const pid_t child = ::fork();
  if (child == 0) {
    FileCopies copies;
    copies.take(path);
    const fs::path place = fs::path(path).parent_path();
    if (!fs::exists(place))
      ::_exit(2);
    remove_temporaries(); // as the signal handlers do
    ::_exit(fs::exists(place) ? 1 : 0);
  }
  int status = -1;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(status == 0);
}
