#include "temporary_folder.h"

#include <wavelet/base/error.h>
#include <wavelet/file/output_file.h>
#include <wavelet/file/temporary_name.h>

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

using namespace haarlight;
namespace fs = std::filesystem;

namespace {

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit([&](const std::string& temporary) { CHECK(content(temporary) == text); });
}

std::ptrdiff_t entries(const std::string& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

} // namespace

TEST_CASE("An output replaces a file on commit only, and leaves nothing else", "[output]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out");
  write(path, "old");
  {
    OutputFile abandoned(path);
    abandoned.write("new", 3);
  }
  CHECK(content(path) == "old");
  write(path, "new");
  CHECK(content(path) == "new");
  CHECK(entries(folder.file("")) == 1);
}

TEST_CASE("A symbolic link is written through", "[output]") {
  const TemporaryFolder folder;
  fs::create_symlink("target", folder.file("link"));
  write(folder.file("link"), "a");
  CHECK(fs::is_symlink(folder.file("link")));
  CHECK(content(folder.file("target")) == "a");
  fs::create_symlink("loop", folder.file("loop"));
  CHECK_THROWS_AS(OutputFile(folder.file("loop")), Error);
  CHECK_THROWS_AS(OutputFile("/proc/self/fd/1"), Error);
}

TEST_CASE("Names of 255 bytes can be written, longer ones are refused at once", "[output]") {
  const TemporaryFolder folder;
  const std::string name(255, 'n');
  write(folder.file(name), "a");
  CHECK(content(folder.file(name)) == "a");
  CHECK_THROWS_AS(OutputFile(folder.file(name + "n")), Error);
}

TEST_CASE("A temporary of no live process is removed, a locked one stays", "[output]") {
  const TemporaryFolder folder;
  const std::string parent = folder.file("");
  const std::string dead = temporary_path(parent.substr(0, parent.size() - 1));
  std::ofstream(dead) << "left";
  const std::string other = folder.file(".haarlight-tmp.another-host.1.0123456789abcdef");
  std::ofstream(other) << "live elsewhere";
  write(folder.file("out"), "a");
  CHECK_FALSE(fs::exists(dead));
  CHECK(fs::exists(other));
}
