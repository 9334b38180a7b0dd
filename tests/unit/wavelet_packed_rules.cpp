#include "set_files.h"
#include "temporary_folder.h"

#include <wavelet/error.h>
#include <wavelet/packed_set.h>

#include <catch2/catch.hpp>

#include <zstd.h>

#include <functional>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

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
      {"bytes after the last frame", [](Parts& p) { p.behind.push_back('x'); }},
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
