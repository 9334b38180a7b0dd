#include "set_files.h"
#include "small_unpacker.h"
#include "temporary_folder.h"

#include <wavelet/error.h>
#include <wavelet/packed_set.h>
#include <wavelet/parallel.h>

#include <catch2/catch.hpp>

#include <zstd.h>

#include <algorithm>
#include <functional>

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

/// A packed file of one block taken apart, to be changed and put together with right checksums.
struct Parts {
  std::string header; ///< 160 bytes
  std::string text;
  std::uint32_t trees = 0;
  std::vector<std::string> streams;
  std::string behind; ///< bytes after the last frame of the block

  explicit Parts(const std::string& bytes) : header(bytes.substr(0, 160)) {
    std::size_t at = 160;
    const auto take = [&](std::size_t size) {
      std::string content(ZSTD_getFrameContentSize(bytes.data() + at, size), '\0');
      ZSTD_decompress(content.data(), content.size(), bytes.data() + at, size);
      at += size;
      return content;
    };
    text = take(get<std::uint32_t>(bytes, 24));
    trees = get<std::uint32_t>(bytes, at);
    const std::size_t table = at + 16;
    const std::size_t count = 3 + (get<std::uint32_t>(bytes, 72) == 0 ? 2 : 4) * 3;
    at = table + 4 * count;
    for (std::size_t i = 0; i < count; ++i)
      streams.push_back(take(get<std::uint32_t>(bytes, table + 4 * i)));
  }

  static std::string frame(const std::string& content) {
    std::string result(ZSTD_compressBound(content.size()), '\0');
    result.resize(ZSTD_compress(result.data(), result.size(), content.data(), content.size(), 3));
    return result;
  }

  std::string assemble() const {
    std::string sizes;
    std::string frames;
    for (const std::string& stream : streams) {
      const std::string packed = frame(stream);
      sizes += std::string(4, '\0');
      put(sizes, sizes.size() - 4, static_cast<std::uint32_t>(packed.size()));
      frames += packed;
    }
    std::string block = std::string(16, '\0') + sizes + frames + behind;
    put(block, 0, trees);
    put(block, 4, static_cast<std::uint32_t>(block.size()));
    put(block, 8, checksum(block, 16, block.size() - 16));
    const std::string packed_text = frame(text);
    std::string bytes = header;
    put(bytes, 24, static_cast<std::uint32_t>(packed_text.size()));
    bytes += packed_text + block;
    put(bytes, 16, static_cast<std::uint64_t>(bytes.size()));
    seal(bytes);
    return bytes;
  }

  static void seal(std::string& bytes) {
    put(bytes, 32 + 112, checksum(bytes, 32, 112));
    put(bytes, 152, checksum(bytes, 0, 152));
  }
};

/// A packed set of two rounded trees in one block.
std::string packed_example(const TemporaryFolder& folder) {
  const std::string path = folder.file("example.haar");
  CompressOptions options = keep_all();
  options.quantize = true;
  options.threshold.tolerance = 0.05;
  options.packed = true;
  write_set(path, RandomSource(8, 2, 1), options);
  return read_bytes(path);
}

void check_refused(const TemporaryFolder& folder, const char* rule, const std::string& bytes) {
  write_bytes(folder.file("broken.haar"), bytes);
  INFO(rule);
  CHECK_THROWS_AS(open_tree_set(folder.file("broken.haar")), Error);
}

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
      const auto map = reader.map(static_cast<std::size_t>(i));
      for (std::size_t p = 0; p < map.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(map[p][c] - expected.rgb[3 * p + c]));
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

TEST_CASE("every broken rule of the packed header is refused") {
  const TemporaryFolder folder;
  const std::string good = packed_example(folder);
  using Bytes = std::string;
  const std::vector<std::pair<const char*, std::function<void(Bytes&)>>> in_header = {
      {"version", [](Bytes& b) { put(b, 8, 2U); }},
      {"header size", [](Bytes& b) { put(b, 12, 128U); }},
      {"file size", [](Bytes& b) { b += '\0'; }},
      {"truncation", [](Bytes& b) { b.resize(b.size() - 9); }},
      {"header only", [](Bytes& b) { b.resize(100); }},
      {"text frame beyond the end", [](Bytes& b) { put(b, 24, 1U << 30U); }},
      {"no blocks", [](Bytes& b) { put(b, 28, 0U); }},
      {"too many blocks", [](Bytes& b) { put(b, 28, 2U); }},
      {"mapped magic", [](Bytes& b) { b[33] = 'x'; }},
      {"mapped levels", [](Bytes& b) { put(b, 32 + 32, 14U); }},
      {"another number of levels", [](Bytes& b) { put(b, 32 + 32, 4U); }},
      {"another number of channels", [](Bytes& b) { put(b, 32 + 36, 1U); }},
      {"another type", [](Bytes& b) { put(b, 32 + 40, 1U); }},
      {"mapped kind", [](Bytes& b) { put(b, 32 + 24, 3U); }},
      {"more columns than trees", [](Bytes& b) { put(b, 32 + 48, 65536U); }},
      {"mapped file size", [](Bytes& b) { put(b, 32 + 16, std::uint64_t{1} << 40U); }},
      {"mapped index offset",
       [](Bytes& b) {
         put(b, 32 + 64, std::uint64_t{128});
         put(b, 32 + 80, std::uint64_t{128 + 80});
         put(b, 32 + 16, 128 + 80 + get<std::uint64_t>(b, 32 + 88));
       }},
      {"mapped index checksum", [](Bytes& b) { b[32 + 72] ^= 1; }},
      {"mapped text checksum", [](Bytes& b) { b[32 + 96] ^= 1; }},
      {"text size",
       [](Bytes& b) {
         put(b, 32 + 88, get<std::uint64_t>(b, 32 + 88) + 1);
         put(b, 32 + 16, get<std::uint64_t>(b, 32 + 16) + 1);
       }},
      {"text beyond a MiB", [](Bytes& b) {
         put(b, 32 + 88, std::uint64_t{1} << 21U);
         put(b, 32 + 16, get<std::uint64_t>(b, 32 + 80) + (1U << 21U));
       }}};
  for (const auto& [rule, damage] : in_header) {
    std::string bytes = good;
    damage(bytes);
    if (bytes.size() >= 160)
      Parts::seal(bytes);
    check_refused(folder, rule, bytes);
  }
}

TEST_CASE("every broken rule of a packed block is refused") {
  const TemporaryFolder folder;
  const Parts parts(packed_example(folder));
  write_bytes(folder.file("good.haar"), parts.assemble());
  REQUIRE_NOTHROW(open_tree_set(folder.file("good.haar"))); // taking apart changes nothing
  const auto node = [](Parts& p) -> char& { return p.streams[2][0]; };
  const std::vector<std::pair<const char*, std::function<void(Parts&)>>> in_block = {
      {"no trees", [](Parts& p) { p.trees = 0; }},
      {"more trees than the set has", [](Parts& p) { p.trees = 3; }},
      {"too many trees", [](Parts& p) { p.trees = 4097; }},
      {"bytes after the last frame", [](Parts& p) { p.behind = "x"; }},
      {"text", [](Parts& p) { p.text[8] ^= 1; }},
      {"records too short", [](Parts& p) { p.streams[0].pop_back(); }},
      {"record with more nodes than squares", [](Parts& p) { p.streams[0][2] = 1; }},
      {"record with 2^28 nodes", [](Parts& p) { p.streams[0][6] = 16; }},
      {"record of fewer nodes", [](Parts& p) { --p.streams[0][0]; }},
      {"scale 0", [](Parts& p) { p.streams[0].replace(8, 8, 8, '\0'); }},
      {"mean not finite",
       [](Parts& p) {
         for (std::size_t k = 0; k < 4; ++k)
           p.streams[0][2 * (8 + k)] = '\xff';
       }},
      {"another mean", [](Parts& p) { p.streams[0][16] ^= 1; }},
      {"forms too long", [](Parts& p) { p.streams[1] += '\1'; }},
      {"form of an exponent too large", [](Parts& p) { p.streams[1][0] = 41; }},
      {"another form", [](Parts& p) { --p.streams[1][0]; }},
      {"structure too short", [](Parts& p) { p.streams[2].pop_back(); }},
      {"structure bit 7", [=](Parts& p) { node(p) = static_cast<char>(node(p) | '\x80'); }},
      {"child mask", [=](Parts& p) { node(p) ^= 1; }},
      {"children at the last level", [](Parts& p) { p.streams[2].back() |= 1; }},
      {"presence", [=](Parts& p) { node(p) ^= 0x10; }},
      {"plane too short", [](Parts& p) { p.streams[3].pop_back(); }},
      {"plane too long", [](Parts& p) { p.streams[8] += '\0'; }},
      {"coefficient that is no half",
       [](Parts& p) {
         p.streams[3][0] = '\x02'; // 2049 takes twelve digits
         p.streams[4][0] = '\x10';
       }},
      {"coefficient beyond the halves",
       [](Parts& p) {
         p.streams[1][0] = 40;
         p.streams[4][0] = '\x10';
       }},
      {"present coefficient of 0",
       [](Parts& p) {
         for (std::size_t k = 3; k < 9; ++k)
           p.streams[k][0] = 0;
       }},
      {"half that is not finite", [](Parts& p) {
         p.streams[1][0] = 0;
         p.streams[3][0] = 0;
         p.streams[4][0] = '\xf8';
       }}};
  for (const auto& [rule, damage] : in_block) {
    Parts broken = parts;
    damage(broken);
    check_refused(folder, rule, broken.assemble());
  }
}

TEST_CASE("a frame that claims more than the trees need is not unpacked") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  CompressOptions options = keep_all();
  options.packed = true;
  write_set(path, RandomSource(8, 2, 1), options);
  Parts parts(read_bytes(path));
  const std::string good = parts.assemble();
  for (std::size_t i = 0; i < parts.streams.size(); ++i) {
    Parts bomb = parts;
    bomb.streams[i] = std::string(std::size_t{1} << 26U, '\0');
    const std::string bytes = bomb.assemble();
    CHECK(bytes.size() < good.size() + 10000);
    write_bytes(path, bytes);
    try {
      open_tree_set(path);
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(std::string(error.what()).find("does not hold as many bytes") != std::string::npos);
    }
  }
}

TEST_CASE("any flipped byte of a packed file is noticed") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  CompressOptions options = keep_all();
  options.packed = true;
  write_set(path, RandomSource(4, 1, 1), options);
  const std::string good = read_bytes(path);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x20);
    write_bytes(path, bytes);
    INFO("byte " << i);
    CHECK_THROWS_AS(open_tree_set(path), Error);
  }
}
