// Map sets as EXR files: what is written is read, the same bytes for any number of threads, and
// nothing broken gets through.
#include "fixture.h"

#include <image/image_exr.h>
#include <image/map_set_exr.h>

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace haarlight;
using namespace haarlight::testing;
using wavelet::Fold;
using wavelet::Map;
using wavelet::SetInfo;
using wavelet::SetKind;

namespace {

image::MapSetResult write(const wavelet::MapSource& source, const std::string& path) {
  OutputFile file(path);
  const image::MapSetResult result = image::write_map_set_exr(source, file);
  image::commit_exr(file);
  return result;
}

NumberedMaps brdf_set() {
  NumberedMaps maps(16, 6, 3);
  SetInfo& info = maps.info();
  info.kind = SetKind::Brdf;
  info.rolls = 12;
  info.fold = Fold::Rotations;
  info.cosine = true;
  info.frame = "z = the mirror direction";
  info.provenance.set("hash", "0123");
  return maps;
}

void require_refused(const std::string& path, const std::string& words) {
  try {
    const image::ExrMapSource source(path);
    for (int row = 0; row < source.info().rows; ++row)
      for (int column = 0; column < source.info().columns; ++column)
        source.make(column, row);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::Input);
    CHECK(error.path() == path);
    CHECK_THAT(error.what(), Catch::Contains(words));
    return;
  }
  FAIL("accepted, expected: " + words);
}

/// A grey scanline EXR.
void write_plain(const std::string& path, int width, int height, float value) {
  Image picture(width, height);
  std::fill(picture.rgb.begin(), picture.rgb.end(), value);
  image::write_exr(path, picture);
}

} // namespace

TEST_CASE("a map set survives the EXR exactly", "[map_set_exr]") {
  const TemporaryFolder folder;
  const NumberedMaps maps = brdf_set();
  const auto result = write(maps, folder.file("set.exr"));
  CHECK(result.bytes == std::filesystem::file_size(folder.file("set.exr")));
  CHECK_FALSE(result.conservation);
  const image::ExrMapSource source(folder.file("set.exr"));
  const SetInfo& info = source.info();
  CHECK(info.kind == SetKind::Brdf);
  CHECK(info.size == 16);
  CHECK(info.columns == 6);
  CHECK(info.rows == 3);
  CHECK(info.rolls == 12);
  CHECK(info.fold == Fold::Rotations);
  CHECK(info.cosine);
  CHECK_FALSE(info.world_frame);
  CHECK(info.frame == "z = the mirror direction");
  CHECK(info.units == "sr^-1");
  CHECK(info.provenance.text() == maps.info().provenance.text());
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 6; ++column)
      CHECK(source.make(column, row).rgb == maps.make(column, row).rgb);
}

TEST_CASE("maps are read from several threads at once", "[map_set_exr]") {
  const TemporaryFolder folder;
  const NumberedMaps maps(32, 9, 5);
  write(maps, folder.file("set.exr"));
  const image::ExrMapSource source(folder.file("set.exr"));
  std::vector<char> same(45);
  parallel_for(45, [&](std::size_t i) {
    const int index = static_cast<int>(i);
    same[i] = source.make(index % 9, index / 9).rgb == maps.make(index % 9, index / 9).rgb ? 1 : 0;
  });
  CHECK(std::count(same.begin(), same.end(), 1) == 45);
}

TEST_CASE("the bytes do not depend on the number of threads", "[map_set_exr]") {
  const TemporaryFolder folder;
  const NumberedMaps maps = brdf_set();
  {
    const ThreadLimit one(1);
    write(maps, folder.file("one.exr"));
  }
  const ThreadLimit more(3);
  write(maps, folder.file("more.exr"));
  CHECK(read_bytes(folder.file("one.exr")) == read_bytes(folder.file("more.exr")));
}

TEST_CASE("a plain square picture is a set of one map", "[map_set_exr]") {
  const TemporaryFolder folder;
  write_plain(folder.file("plain.exr"), 8, 8, 0.5F);
  const image::ExrMapSource source(folder.file("plain.exr"));
  CHECK(source.info().kind == SetKind::Generic);
  CHECK(source.info().map_count() == 1);
  CHECK(source.info().provenance.get("source") == "plain.exr");
  CHECK(source.make(0, 0).rgb == std::vector<float>(192, 0.5F));
}

TEST_CASE("pictures that are no maps are refused", "[map_set_exr]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("bad.exr");
  write_plain(path, 8, 4, 1);
  require_refused(path, "8 x 4 pixels");
  write_plain(path, 12, 12, 1);
  require_refused(path, "power of two");
  write_plain(path, 8, 8, std::numeric_limits<float>::quiet_NaN());
  require_refused(path, "map 0,0: pixel 0,0 is not finite");
  write_bytes(path, "Lorem ipsum dolor sit amet");
  require_refused(path, "no EXR image");
  write_bytes(path, "");
  require_refused(path, "no EXR image");
}

TEST_CASE("an infinite pixel of a set is named", "[map_set_exr]") {
  class Infinite : public NumberedMaps {
  public:
    using NumberedMaps::NumberedMaps;
    Map make(int column, int row) const override {
      Map map = NumberedMaps::make(column, row);
      if (column == 2 && row == 1)
        map.rgb[map.offset(3, 5) + 1] = std::numeric_limits<float>::infinity();
      return map;
    }
  };
  const TemporaryFolder folder;
  write(Infinite(8, 3, 2), folder.file("set.exr"));
  require_refused(folder.file("set.exr"), "map 2,1: pixel 3,5 is not finite");
}

TEST_CASE("a set that is cut off anywhere is refused", "[map_set_exr]") {
  const TemporaryFolder folder;
  write(brdf_set(), folder.file("set.exr"));
  const std::string bytes = read_bytes(folder.file("set.exr"));
  for (std::size_t length = 0; length < bytes.size(); length += 61) {
    write_bytes(folder.file("cut.exr"), bytes.substr(0, length));
    CHECK_THROWS_AS(([&] {
                      const image::ExrMapSource source(folder.file("cut.exr"));
                      for (int i = 0; i < 18; ++i)
                        source.make(i % 6, i / 6);
                    }()),
                    Error);
  }
}

TEST_CASE("damaged bytes never crash", "[map_set_exr]") {
  const TemporaryFolder folder;
  write(brdf_set(), folder.file("set.exr"));
  const std::string bytes = read_bytes(folder.file("set.exr"));
  int refused = 0;
  for (std::size_t i = 0; i < 1500; ++i) {
    std::string damaged = bytes;
    damaged[i * 7919 % (i % 2 == 0 ? 1300 : bytes.size())] ^= static_cast<char>(1 + i % 255);
    write_bytes(folder.file("damaged.exr"), damaged);
    try {
      const image::ExrMapSource source(folder.file("damaged.exr"));
      source.make(0, 0);
    } catch (const Error&) {
      ++refused;
    }
  }
  CHECK(refused > 300);
}

TEST_CASE("a set is not written where it cannot be", "[map_set_exr]") {
  const TemporaryFolder folder;
  const NumberedMaps maps(8, 2, 2);
  CHECK_THROWS_AS(write(maps, folder.file("missing/set.exr")), Error);
  std::filesystem::create_directory(folder.file("taken.exr"));
  CHECK_THROWS_AS(write(maps, folder.file("taken.exr")), Error);
  CHECK(std::filesystem::is_empty(folder.file("taken.exr")));
  CHECK_FALSE(std::filesystem::exists(folder.file("missing")));
}
