#include "set_files.h"
#include "small_reader.h"
#include "temporary_folder.h"

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <cstdio>
#include <functional>
#include <sstream>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// Makes all checksums right again, so that a rule is tested and not its checksum.
void seal(std::string& bytes) {
  const auto index = get<std::uint64_t>(bytes, 64);
  const std::size_t count = get<std::uint32_t>(bytes, 48) * get<std::uint32_t>(bytes, 52);
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin = get<std::uint64_t>(bytes, index + 40 * i);
    const auto end = i + 1 < count ? get<std::uint64_t>(bytes, index + 40 * (i + 1)) : index;
    put(bytes, index + 40 * i + 8, checksum(bytes, begin, end - begin));
  }
  put(bytes, 72, checksum(bytes, index, 40 * count));
  put(bytes, 112, checksum(bytes, 0, 112));
}

/// The tree of FORMAT.md's example.
class ExampleSource : public MapSource {
public:
  ExampleSource() {
    m_info.size = 4;
    m_info.units = "1";
  }
  const SetInfo& info() const override { return m_info; }
  Map make(int /*column*/, int /*row*/) const override {
    Map map(4);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        map.set(x, y, Rgb(static_cast<float>(1 + x / 2), static_cast<float>(2 + y / 2), 4));
    map.set(3, 3, Rgb(6, 7, 8));
    return map;
  }

private:
  SetInfo m_info;
};

std::string hex_dump(const std::string& bytes) {
  std::string dump;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    char text[32];
    if (i % 16 == 0) {
      std::snprintf(text, sizeof text, "%s%04zx ", i == 0 ? "" : "\n", i);
      dump += text;
    }
    std::snprintf(text, sizeof text, " %02x", static_cast<unsigned char>(bytes[i]));
    dump += text;
  }
  return dump + "\n";
}

} // namespace

TEST_CASE("a set comes back from its file, and a reader written from FORMAT.md reads the same") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  const RandomSource source(16, 3, 2);
  for (const CoefficientType type : {CoefficientType::Half, CoefficientType::Float}) {
    for (const bool luminance_only : {false, true}) {
      CompressOptions options = keep_all(type);
      options.luminance = luminance_only;
      write_set(path, source, options);
      const TreeSet set(path);
      const SmallReader reader(path);
      CHECK(set.info().columns == 3);
      CHECK(set.info().rows == 2);
      CHECK(set.info().units == "none");
      CHECK(set.info().provenance.get("source") == "random");
      CHECK(reader.text().find("units=none\nsource=random\n") != std::string::npos);
      float worst = 0;
      for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column) {
          CompressReport report;
          const Tree tree = compress_map(source.make(column, row), options, report);
          const Map expected = tree.view().reconstruct(4);
          const Map mapped = set.tree(column, row).reconstruct(4);
          CHECK(expected.rgb == mapped.rgb);
          worst = std::max(worst, largest_difference(reader.map(static_cast<unsigned>(column),
                                                                static_cast<unsigned>(row)),
                                                     mapped));
        }
      CHECK(worst < 1e-4F);
    }
  }
}

TEST_CASE("the same set makes the same bytes for any number of threads") {
  const TemporaryFolder folder;
  const RandomSource source(32, 5, 3);
  {
    const ThreadLimit one(1);
    write_set(folder.file("one.haar"), source, {});
  }
  const ThreadLimit four(4);
  write_set(folder.file("four.haar"), source, {});
  CHECK(read_bytes(folder.file("one.haar")) == read_bytes(folder.file("four.haar")));
}

TEST_CASE("the example of FORMAT.md is what the library writes") {
  const TemporaryFolder folder;
  const std::string path = folder.file("example.haar");
  OutputFile file(path);
  CompressReport report;
  const ExampleSource source;
  TreeSetWriter writer(file, source.info(), 3, CoefficientType::Half);
  writer.add(compress_map(source.make(0, 0), keep_all(), report));
  writer.finish();
  file.commit();
  std::ifstream in(HAARLIGHT_SOURCE_DIR "/libwavelet/FORMAT.md");
  std::stringstream page;
  page << in.rdbuf();
  INFO(hex_dump(read_bytes(path)));
  CHECK(page.str().find("```hex\n" + hex_dump(read_bytes(path)) + "```") != std::string::npos);
}

TEST_CASE("every broken rule is refused") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(8, 2, 1), keep_all());
  const std::string good = read_bytes(path);
  const auto index = get<std::uint64_t>(good, 64);
  const auto tree = get<std::uint64_t>(good, index);
  const float nan = std::nanf("");
  struct Break {
    const char* rule;
    std::function<void(std::string&)> damage;
    bool sealed;
  };
  const std::vector<Break> breaks = {
      {"magic", [](auto& b) { b[0] = 'x'; }, true},
      {"version", [](auto& b) { put(b, 8, 2U); }, true},
      {"header size", [](auto& b) { put(b, 12, 128U); }, true},
      {"file size", [](auto& b) { b += '\0'; }, true},
      {"truncation", [](auto& b) { b.resize(b.size() - 9); }, false},
      {"header only", [](auto& b) { b.resize(100); }, false},
      {"kind", [](auto& b) { put(b, 24, 4U); }, true},
      {"domain", [](auto& b) { put(b, 28, 0U); }, true},
      {"levels", [](auto& b) { put(b, 32, 14U); }, true},
      {"channels", [](auto& b) { put(b, 36, 2U); }, true},
      {"coefficient type", [](auto& b) { put(b, 40, 2U); }, true},
      {"fold", [](auto& b) { put(b, 44, 3U); }, true},
      {"columns", [](auto& b) { put(b, 48, 0U); }, false},
      {"columns times rows",
       [](auto& b) {
         for (const std::size_t field : {48, 52, 56})
           put(b, field, 65536U);
         put(b, 112, checksum(b, 0, 112));
       },
       false},
      {"rolls", [](auto& b) { put(b, 56, 4U); }, true},
      {"flags", [](auto& b) { put(b, 60, 4U); }, true},
      {"reserved", [](auto& b) { put(b, 104, std::uint64_t{1}); }, true},
      {"padding", [](auto& b) { b[121] = 1; }, true},
      {"header checksum", [](auto& b) { b[24] = 1; }, false},
      {"index offset",
       [](auto& b) {
         put(b, 64, std::uint64_t{1} << 40U);
         put(b, 112, checksum(b, 0, 112));
       },
       false},
      {"index checksum", [=](auto& b) { b[index + 25] = 1; }, false},
      {"text checksum", [](auto& b) { b[b.size() - 2] = '?'; }, false},
      {"tree offset",
       [=](auto& b) {
         put(b, index, tree + 8);
         put(b, 72, checksum(b, index, 80));
         put(b, 112, checksum(b, 0, 112));
       },
       false},
      {"gap between trees",
       [=](auto& b) {
         b.insert(index, 16, '\0');
         put(b, index + 16 + 40, get<std::uint64_t>(b, index + 16 + 40) + 16);
         for (const std::size_t field : {16, 64, 80})
           put(b, field, get<std::uint64_t>(b, field) + 16);
       },
       true},
      {"gap before the index",
       [=](auto& b) {
         b.insert(index, 16, '\0');
         for (const std::size_t field : {16, 64, 80})
           put(b, field, get<std::uint64_t>(b, field) + 16);
       },
       true},
      {"padding after a tree", [=](auto& b) { b[index - 1] = 1; }, true},
      {"node count", [=](auto& b) { put(b, index + 16, 1U << 28U); }, true},
      {"too many nodes", [=](auto& b) { put(b, index + 16, 1U << 27U); }, true},
      {"scale", [=](auto& b) { put(b, index + 20, 0.0F); }, true},
      {"mean", [=](auto& b) { put(b, index + 24, nan); }, true},
      {"entry reserved", [=](auto& b) { put(b, index + 36, 1U); }, true},
      {"tree checksum", [=](auto& b) { b[tree + 40] ^= 1; }, false},
      {"level table start", [=](auto& b) { put(b, tree, 1U); }, true},
      {"level table descends", [=](auto& b) { put(b, tree + 8, 0U); }, true},
      {"level table end", [=](auto& b) { put(b, tree + 12, 4U); }, true},
      {"first child", [=](auto& b) { put(b, tree + 16, get<std::uint32_t>(b, tree + 16) + 16); },
       true},
      {"child mask", [=](auto& b) { put(b, tree + 16, get<std::uint32_t>(b, tree + 16) ^ 1U); },
       true},
      {"coefficient",
       [=](auto& b) {
         put(b, tree + 16 + 4 * get<std::uint32_t>(b, index + 16), std::uint16_t{0x7c00});
       },
       true},
  };
  for (const Break& b : breaks) {
    std::string bytes = good;
    b.damage(bytes);
    if (b.sealed)
      seal(bytes);
    write_bytes(path, bytes);
    INFO(b.rule);
    CHECK_THROWS_AS(TreeSet(path), Error);
  }
  write_bytes(path, good);
  CHECK_NOTHROW(TreeSet(path));
}

TEST_CASE("any flipped byte is noticed") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(4, 1, 1), keep_all());
  const std::string good = read_bytes(path);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x20);
    write_bytes(path, bytes);
    INFO("byte " << i);
    CHECK_THROWS_AS(TreeSet(path), Error);
  }
}

TEST_CASE("checked when used, a set hands out no broken tree, and opens all the same") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(8, 3, 1), keep_all());
  std::string bytes = read_bytes(path);
  const auto second = get<std::uint64_t>(bytes, get<std::uint64_t>(bytes, 64) + 40);
  bytes[second + 60] ^= 1;
  write_bytes(path, bytes);
  CHECK_THROWS_AS(TreeSet(path), Error);
  const TreeSet set(path, Check::WhenUsed);
  CHECK(set.tree(0, 0).reconstruct(3).rgb.size() == 3 * 64);
  CHECK(set.level_nodes(2, 0, 1) > 0);
  for (int again = 0; again < 2; ++again) {
    CHECK_THROWS_AS(set.tree(1, 0), Error);
    CHECK_THROWS_AS(set.level_nodes(1, 0, 0), Error);
  }
  put(bytes, get<std::uint64_t>(bytes, 64) + 16, 5U); // the index is checked either way
  write_bytes(path, bytes);
  CHECK_THROWS_AS(TreeSet(path, Check::WhenUsed), Error);
}

TEST_CASE("what is no .haar file is refused with the right kind of error") {
  const TemporaryFolder folder;
  write_bytes(folder.file("text"), "hello, world\n");
  write_bytes(folder.file("empty"), "");
  for (const char* name : {"text", "empty", "missing", ""})
    try {
      const TreeSet set(folder.file(name));
      FAIL("accepted " << name);
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::Input);
      CHECK(std::string(error.what()).find(folder.file(name)) == 0);
    }
}

TEST_CASE("what happens to a file after it was opened changes no tree") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(16, 2, 1), keep_all());
  const std::string good = read_bytes(path);
  const TreeSet set(path);
  const Map expected = set.tree(1, 0).reconstruct(4);
  for (const std::string& bytes : {std::string(), std::string(good.size(), '\xff')}) {
    write_bytes(path, bytes); // truncates and writes in place
    CHECK(set.tree(1, 0).reconstruct(4).rgb == expected.rgb);
  }
}

TEST_CASE("a file that changes before its trees are read is refused") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(16, 2, 1), keep_all());
  const std::string good = read_bytes(path);
  for (const std::string& bytes : {good.substr(0, 200), std::string(good.size(), '\xff')}) {
    write_bytes(path, good);
    const TreeSet set(path, Check::WhenUsed);
    write_bytes(path, bytes);
    CHECK_THROWS_AS(set.tree(0, 0), Error);
  }
}
