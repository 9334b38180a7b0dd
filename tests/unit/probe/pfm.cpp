#include "probe_files.h"

#include <probe/read_probe.h>

#include <cstring>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::error_of;
using haarlight::testing::ProbeFolder;

namespace {

std::string floats(const std::vector<float>& values, bool big_endian = false) {
  std::string bytes;
  for (const float value : values) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    if (big_endian)
      std::swap(raw[0], raw[3]), std::swap(raw[1], raw[2]);
    bytes.append(raw, 4);
  }
  return bytes;
}

const std::vector<float> column = {1, 2, 3, 4, 5, 6}; // bottom row first

} // namespace

TEST_CASE("Line ends, byte orders and scales of PFM", "[pfm]") {
  const ProbeFolder folder;
  const std::string files[] = {
      "PF\n1 2\n-1.0\n" + floats(column),
      "PF\r\n1 2\r\n-1.0\r\n" + floats(column),
      "PF 1 2 -1 " + floats(column),
      "PF\n1\n2\n1.000000\n" + floats(column, true),
      "PF\r\n1 2\r\n+1\r\n" + floats(column, true),
      "PF\n1 2\n-0.5\n" + floats({2, 4, 6, 8, 10, 12}),
      "PF\n1 2\n-8.507059173023462e+37\n" +
          floats({0x1p-126F, 0x2p-126F, 0x3p-126F, 0x4p-126F, 0x5p-126F, 0x6p-126F})};
  for (const std::string& bytes : files) {
    const auto loaded = read_image(folder.write("a.hdr", bytes));
    INFO(bytes.substr(0, 20));
    REQUIRE((loaded.image.width == 1 && loaded.image.height == 2));
    CHECK((loaded.image.at(0, 0) == Rgb(4, 5, 6)).all());
    CHECK((loaded.image.at(0, 1) == Rgb(1, 2, 3)).all());
  }
  const auto rgba = read_image(folder.write("a", "PF4\n1 1\n-1\n" + floats({1, 2, 3, 9})));
  CHECK((rgba.image.at(0, 0) == Rgb(1, 2, 3)).all());
  CHECK(rgba.notes.size() == 1);
}

TEST_CASE("A first byte of data that looks like a line feed is data", "[pfm]") {
  const ProbeFolder folder;
  std::string data = floats({1, 2, 3});
  data[0] = '\n';
  float first = 0;
  std::memcpy(&first, data.data(), 4);
  const auto loaded = read_image(folder.write("a.pfm", "PF\n1 1\n-1\n" + data));
  CHECK(loaded.image.at(0, 0)[0] == first);
}

TEST_CASE("PFM files of a wrong size or header are refused", "[pfm]") {
  const ProbeFolder folder;
  const std::string files[] = {"PF\n1 2\n-1.0\n" + floats({1, 2, 3}),
                               "PF\n1 2\n-1.0\n" + floats(column) + "x",
                               "PF\n1 2\n0\n" + floats(column),
                               "PF\n1 2\nnan\n" + floats(column),
                               "PF\n-1 2\n-1\n" + floats(column),
                               "PF\n1e3 2\n-1\n" + floats(column),
                               "PF\n100000 100000\n-1\n" + floats(column),
                               "PF\n134217728 1\n-1\n" + floats(column),
                               "PF\n1 2\n-1",
                               "PF\n" + std::string(1000, '1')};
  for (const std::string& bytes : files) {
    const std::string message = error_of([&] { read_image(folder.write("a.pfm", bytes)); });
    INFO(message);
    CHECK_THAT(message, Catch::Contains("a.pfm: "));
  }
  CHECK_THAT(error_of([&] {
               read_image(folder.write("a.pfm", "PF\n1 2\n-1\n" + floats(column)), {"beauty", ""});
             }),
             Catch::Contains("no layers"));
}
