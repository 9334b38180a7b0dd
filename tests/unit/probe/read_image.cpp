#include "probe_files.h"

#include <probe/read_probe.h>
#include <probe/rgbe.h>

#include <cmath>
#include <cstring>
#include <limits>

#include <sys/stat.h>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::error_of;
using haarlight::testing::ProbeFolder;

namespace {

/// A portable float map, whose rows run upwards.
std::string pfm(int width, int height, const std::vector<float>& values, bool colour = true) {
  const std::string header = std::string(colour ? "PF\n" : "Pf\n") + std::to_string(width) + " " +
                             std::to_string(height) + "\n-1.0\n";
  std::string bytes(header);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return bytes;
}

std::string refusal(const std::string& path) {
  return error_of([&] { read_image(path); });
}

} // namespace

TEST_CASE("Foreign formats are read upright, grey becomes RGB", "[read_image]") {
  const ProbeFolder folder;
  const auto colour =
      read_image(folder.write("colour.pfm", pfm(1, 2, {1, 2, 3, 4, 5, 6}))); // bottom row first
  REQUIRE((colour.image.width == 1 && colour.image.height == 2));
  CHECK((colour.image.at(0, 0) == Rgb(4, 5, 6)).all());
  CHECK((colour.image.at(0, 1) == Rgb(1, 2, 3)).all());
  CHECK(colour.name == "colour.pfm");
  CHECK(colour.hash.size() == 16);
  CHECK(colour.notes.empty());
  const auto grey = read_image(folder.write("grey.pfm", pfm(2, 1, {0.5F, 7}, false)));
  CHECK((grey.image.at(1, 0) == Rgb(7, 7, 7)).all());
}

TEST_CASE("Formats that are not accepted are refused by name", "[read_image]") {
  const ProbeFolder folder;
  const std::string rest(100, '\1');
  const std::pair<std::string, std::string> files[] = {
      {"DDS " + rest, "DDS"},       {"BM" + rest, "BMP"},     {"\x01\xda" + rest, "SGI"},
      {"P6\n1 1\n255\nabc", "PPM"}, {"GIF89a" + rest, "GIF"}, {"SDPX" + rest, "DPX"}};
  for (const auto& [bytes, name] : files) {
    const std::string message = refusal(folder.write("picture.exr", bytes));
    INFO(message);
    CHECK_THAT(message, Catch::Contains(name) && Catch::Contains("OpenEXR"));
  }
}

TEST_CASE("RGBE is known by its content, whatever its name", "[read_image]") {
  const ProbeFolder folder;
  Image image(8, 8);
  image.set(3, 2, {1, 2, 4});
  write_rgbe(folder.path("probe.exr"), image);
  CHECK((read_image(folder.path("probe.exr")).image.at(3, 2) == Rgb(1, 2, 4)).all());
}

TEST_CASE("NaN and infinity are refused by pixel, negative values clamped", "[read_image]") {
  const ProbeFolder folder;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::string with_nan =
      folder.write("nan.pfm", pfm(2, 2, {1, 1, 1, 1, nan, 1, 1, 1, 1, 1, 1, 1}));
  CHECK_THAT(refusal(with_nan), Catch::Contains("column 1, row 1") && Catch::Contains("NaN"));
  const std::string with_inf = folder.write("inf.pfm", pfm(2, 1, {1, 1, 1, 1, 1, -infinity}));
  CHECK_THAT(refusal(with_inf), Catch::Contains("column 1, row 0") && Catch::Contains("infinity"));
  const auto negative = read_image(folder.write("negative.pfm", pfm(2, 1, {-1, 1, 1, 1, -2, 1})));
  CHECK((negative.image.at(0, 0) == Rgb(0, 1, 1)).all());
  REQUIRE(negative.notes.size() == 1);
  CHECK_THAT(negative.notes[0], Catch::Contains("2 negative"));
}

TEST_CASE("Pictures that cannot be read end in one clear line", "[read_image]") {
  const ProbeFolder folder;
  const std::string whole = pfm(4, 4, std::vector<float>(48, 1.0F));
  std::vector<std::string> paths = {folder.path("missing.hdr"),
                                    folder.path(""),
                                    folder.write("empty.hdr", ""),
                                    folder.write("text.hdr", "not a picture\nat all\n"),
                                    folder.write("text.txt", "not a picture\nat all\n"),
                                    folder.write("text.exr", "not a picture\nat all\n"),
                                    folder.write("cut.pfm", whole.substr(0, whole.size() - 40)),
                                    folder.write("cut.hdr", "#?RADIANCE\n\n-Y 16 +X 16\nabc"),
                                    folder.write("huge.pfm", "PF\n1000000 1000000\n-1.0\nabc")};
  ::mkfifo(folder.path("fifo.hdr").c_str(), 0600);
  paths.push_back(folder.path("fifo.hdr"));
  for (const std::string& path : paths) {
    const std::string message = refusal(path);
    INFO(path << ": " << message);
    CHECK_THAT(message, Catch::StartsWith(path + ": "));
    CHECK(message.find('\n') == std::string::npos);
  }
}

TEST_CASE("A probe is read with its mapping and origin", "[read_image]") {
  const ProbeFolder folder;
  Image image(64, 32);
  for (float& value : image.rgb)
    value = 0.5F;
  write_rgbe(folder.path("sky.hdr"), image);
  const LoadedProbe loaded = read_probe(folder.path("sky.hdr"));
  CHECK(loaded.probe.mapping() == Mapping::LatLong);
  CHECK_THAT(loaded.mapping_reason, Catch::Contains("twice as wide"));
  CHECK(loaded.source.get("source") == "sky.hdr");
  CHECK(loaded.source.get("source_hash").size() == 16);
  CHECK(loaded.source.get("mapping") == "latlong");
  CHECK_THAT(error_of([&] { read_probe(folder.path("sky.hdr"), Mapping::Angular); }),
             Catch::Contains("must be square") && Catch::Contains("sky.hdr"));
}
