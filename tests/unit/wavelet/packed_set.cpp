#include "set_files.h"
#include "small_unpacker.h"
#include "temporary_folder.h"

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/tree_set.h>

#include <catch2/catch.hpp>

#include <algorithm>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

void pack_file(const std::string& from, const std::string& to) {
  OutputFile file(to);
  pack(from, file);
  file.commit();
}

void unpack_file(const std::string& from, const std::string& to) {
  OutputFile file(to);
  unpack(from, file);
  file.commit();
}

/// A set of constant maps: trees without nodes.
class ConstantSource : public RandomSource {
public:
  using RandomSource::RandomSource;
  Map make(int column, int /*row*/) const override {
    Map map(info().size);
    std::fill(map.rgb.begin(), map.rgb.end(), static_cast<float>(column));
    return map;
  }
};

struct Variant {
  CoefficientType type;
  bool luminance;
  bool quantize;
};

CompressOptions options_of(const Variant& variant) {
  CompressOptions options = keep_all(variant.type);
  options.luminance = variant.luminance;
  options.quantize = variant.quantize;
  if (variant.quantize)
    options.threshold.tolerance = 0.1;
  return options;
}

const std::vector<Variant> variants = {
    {CoefficientType::Half, false, false},  {CoefficientType::Half, true, false},
    {CoefficientType::Half, false, true},   {CoefficientType::Half, true, true},
    {CoefficientType::Float, false, false}, {CoefficientType::Float, true, true}};

} // namespace

TEST_CASE("packing and unpacking gives the mapped file back, byte for byte") {
  const TemporaryFolder folder;
  const std::string mapped = folder.file("mapped.haar");
  const std::string packed = folder.file("packed.haar");
  const std::string again = folder.file("again.haar");
  for (const Variant& variant : variants)
    for (const int size : {1, 2, 16, 64}) {
      const RandomSource source(size, 3, 2);
      write_set(mapped, source, options_of(variant));
      pack_file(mapped, packed);
      unpack_file(packed, again);
      CHECK(read_bytes(mapped) == read_bytes(again));
      CompressOptions direct = options_of(variant);
      direct.packed = true;
      write_set(again, source, direct);
      CHECK(read_bytes(packed) == read_bytes(again));
      CHECK(file_form(packed) == FileForm::Packed);
      CHECK(file_form(mapped) == FileForm::Mapped);
    }
  write_set(mapped, ConstantSource(8, 5, 1), {});
  pack_file(mapped, packed);
  unpack_file(packed, again);
  CHECK(read_bytes(mapped) == read_bytes(again));
}

TEST_CASE("all halves survive packing: negative zero, subnormals, the largest") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(16, 1, 1), keep_all());
  std::string bytes = read_bytes(path);
  const auto index = get<std::uint64_t>(bytes, 64);
  const std::size_t start = 128 + 4 * (5 + get<std::uint32_t>(bytes, index + 16));
  const std::uint16_t odd[] = {0x8000, 1, 0x8001, 0x7bff, 0xfbff, 0x0400, 0, 0x3c00, 0x83ff};
  for (std::size_t i = 0; i < 9; ++i)
    put(bytes, start + 2 * (9 * i + 100 + i), odd[i]);
  put(bytes, index + 8, checksum(bytes, 128, index - 128));
  put(bytes, 72, checksum(bytes, index, 40));
  put(bytes, 112, checksum(bytes, 0, 112));
  write_bytes(path, bytes);
  pack_file(path, folder.file("packed.haar"));
  unpack_file(folder.file("packed.haar"), folder.file("again.haar"));
  CHECK(bytes == read_bytes(folder.file("again.haar")));
}

TEST_CASE("a reader of packed files written from FORMAT.md reads the same maps") {
  const TemporaryFolder folder;
  for (const Variant& variant : variants) {
    write_set(folder.file("mapped.haar"), RandomSource(16, 3, 2), options_of(variant));
    pack_file(folder.file("mapped.haar"), folder.file("packed.haar"));
    const TreeSet set(folder.file("mapped.haar"));
    const SmallUnpacker reader(folder.file("packed.haar"));
    CHECK(reader.text().find("units=none\nsource=random\n") != std::string::npos);
    float worst = 0;
    for (int i = 0; i < 6; ++i) {
      const Map expected = set.tree(i % 3, i / 3).reconstruct(4);
      worst =
          std::max(worst, largest_difference(reader.map(static_cast<std::size_t>(i)), expected));
    }
    CHECK(worst < 1e-4F);
  }
}

TEST_CASE("packed bytes do not depend on the number of threads, nor on who packs") {
  const TemporaryFolder folder;
  const RandomSource source(4, 100, 90); // a block takes 4096 trees
  CompressOptions options = keep_all();
  options.packed = true;
  {
    const ThreadLimit one(1);
    write_set(folder.file("one.haar"), source, options);
  }
  const ThreadLimit four(4);
  write_set(folder.file("four.haar"), source, options);
  const std::string bytes = read_bytes(folder.file("one.haar"));
  CHECK(get<std::uint32_t>(bytes, 28) == 3);
  CHECK(bytes == read_bytes(folder.file("four.haar")));
  unpack_file(folder.file("four.haar"), folder.file("mapped.haar"));
  pack_file(folder.file("mapped.haar"), folder.file("again.haar"));
  CHECK(bytes == read_bytes(folder.file("again.haar")));
}

TEST_CASE("a packed file cannot be mapped, and the error says what unpacks it") {
  const TemporaryFolder folder;
  const std::string path = folder.file("packed.haar");
  CompressOptions options;
  options.packed = true;
  write_set(path, RandomSource(8, 2, 1), options);
  try {
    const TreeSet set(path);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find("maps2haar --unpack") != std::string::npos);
  }
  const TreeSet set = open_tree_set(path);
  CHECK(set.info().columns == 2);
  CHECK(set.path() == path);
  CHECK_THROWS_AS(unpack(folder.file("missing"), *std::make_unique<OutputFile>(path)), Error);
}

TEST_CASE("a text section that no writer makes is not packed") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  write_set(path, RandomSource(4, 1, 1), keep_all());
  std::string bytes = read_bytes(path);
  bytes.replace(bytes.find("source=random"), 13, "frame=another");
  const auto text = get<std::uint64_t>(bytes, 80);
  put(bytes, 96, checksum(bytes, text, bytes.size() - text));
  put(bytes, 112, checksum(bytes, 0, 112));
  write_bytes(path, bytes);
  CHECK_NOTHROW(TreeSet(path));
  OutputFile file(folder.file("packed.haar"));
  CHECK_THROWS_AS(pack(path, file), Error);
}
