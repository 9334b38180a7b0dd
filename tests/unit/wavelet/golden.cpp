// Files of version 1 that were made once and never change: whatever is done to the library, it must
// read them to the values that their formula gives, and write the same bytes.
#include "set_files.h"
#include "temporary_folder.h"

#include <wavelet/file/tree_set.h>

#include <catch2/catch.hpp>

#include <zstd.h>

#include <cstdlib>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// Eighths below 2 by integer arithmetic: halves hold all their differences exactly.
class GoldenSource : public MapSource {
public:
  explicit GoldenSource(SetKind kind) {
    m_info.kind = kind;
    m_info.size = 8;
    m_info.frame = "as made by a test";
    m_info.provenance.set("source", "golden");
    if (kind == SetKind::Brdf) {
      m_info.columns = 3;
      m_info.rows = 2;
      m_info.rolls = 8;
      m_info.fold = Fold::Rotations;
      m_info.cosine = true;
      m_info.units = "sr^-1";
    } else {
      m_info.world_frame = true;
      m_info.units = "W sr^-1 m^-2";
    }
  }
  const SetInfo& info() const override { return m_info; }

  Map make(int column, int row) const override {
    Map map(m_info.size);
    for (int y = 0; y < m_info.size; ++y)
      for (int x = 0; x < m_info.size; ++x)
        map.set(x, y,
                Rgb(pixel(x, y, column, row, 0), pixel(x, y, column, row, 1),
                    pixel(x, y, column, row, 2)));
    return map;
  }

private:
  static float pixel(int x, int y, int column, int row, int channel) {
    if (x >= 4 && y >= 4 && column < 2) // a quadrant without detail
      return 1.0F + 0.125F * static_cast<float>(channel);
    return 0.125F *
           static_cast<float>(
               (x * x + 3 * y + 5 * x * y * (1 + column) + 7 * row + channel * (y + 1)) % 16);
  }

  SetInfo m_info;
};

struct Golden {
  const char* name;
  SetKind kind;
  CompressOptions options;
  int packed_version = 2;
};

/// Every kind of tree and stream: halves and floats, colours and luminance, as bits and integers.
std::vector<Golden> golden_files() {
  Golden exact = {"brdf", SetKind::Brdf, keep_all()};
  Golden grey = {"light", SetKind::Light, keep_all(CoefficientType::Float)};
  grey.options.luminance = true;
  Golden rounded = {"rounded", SetKind::Brdf, keep_all()};
  rounded.options.threshold.tolerance = 0.1;
  rounded.options.quantize = true;
  std::vector<Golden> all = {exact, grey, rounded};
  for (Golden& golden : std::vector(all)) {
    golden.options.packed = true;
    all.push_back(golden);
  }
  return all;
}

std::string path_of(const Golden& golden) {
  return std::string(HAARLIGHT_SOURCE_DIR "/tests/golden/") + golden.name +
         (!golden.options.packed       ? ".haar"
          : golden.packed_version == 1 ? ".packed.haar"
                                       : ".packed2.haar");
}

/// With the packed files of version 1, which are read but no longer written.
std::vector<Golden> readable_files() {
  std::vector<Golden> all = golden_files();
  for (Golden& golden : std::vector(all))
    if (golden.options.packed) {
      golden.packed_version = 1;
      all.push_back(golden);
    }
  return all;
}

} // namespace

TEST_CASE("golden files read to the values they were made of") {
  for (const Golden& golden : readable_files()) {
    INFO(path_of(golden));
    const TreeSet set = open_tree_set(path_of(golden));
    const GoldenSource source(golden.kind);
    CHECK(set.info().kind == golden.kind);
    CHECK(set.info().rolls == source.info().rolls);
    CHECK(set.info().fold == source.info().fold);
    CHECK(set.info().units == source.info().units);
    CHECK(set.info().provenance.get("source") == "golden");
    const bool exact = golden.options.threshold.tolerance == 0;
    for (int row = 0; row < source.info().rows; ++row)
      for (int column = 0; column < source.info().columns; ++column) {
        const Map expected = source.make(column, row);
        const Map read = set.tree(column, row).reconstruct(3);
        float worst = 0;
        for (std::size_t i = 0; i < read.rgb.size(); i += 3)
          for (std::size_t c = 0; c < 3; ++c) {
            const Rgb pixel = Eigen::Map<const Rgb>(expected.rgb.data() + i);
            const float value = golden.options.luminance ? luminance(pixel) : pixel[c];
            worst = std::max(worst, std::abs(read.rgb[i + c] - value));
          }
        CHECK(worst < (!exact ? 1.0F : golden.options.luminance ? 1e-6F : 1e-30F));
      }
  }
}

/// Set HAARLIGHT_MAKE_GOLDEN to a folder to make the files of a new version there.
TEST_CASE("golden files are what the library writes") {
  const TemporaryFolder folder;
  const char* wanted = std::getenv("HAARLIGHT_MAKE_GOLDEN");
  for (const Golden& golden : golden_files()) {
    INFO(path_of(golden));
    const std::string name = base_name(path_of(golden));
    const std::string path = wanted != nullptr ? wanted + ("/" + name) : folder.file(name);
    write_set(path, GoldenSource(golden.kind), golden.options);
    // libzstd promises the same content from another version, not the same bytes
    if (!golden.options.packed || ZSTD_versionNumber() == 10504)
      CHECK(read_bytes(path) == read_bytes(path_of(golden)));
    const auto in_place = open_tree_set(path_of(golden)).bytes();
    CHECK(in_place.size() > 128);
  }
}
