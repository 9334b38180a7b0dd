#include "set_files.h"
#include "temporary_folder.h"

#include <wavelet/base/error.h>
#include <wavelet/file/tree_set.h>

#include <catch2/catch.hpp>

#include <zstd.h>

#include <algorithm>
#include <cstring>
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
    const std::size_t text = get<std::uint32_t>(bytes, 24);
    const std::string covered =
        bytes.substr(0, 152) + (bytes.size() < 160 ? "" : bytes.substr(160, text));
    put(bytes, 152, checksum(covered, 0, covered.size()));
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

/// Opens a file of these bytes without writing it.
TreeSet open_bytes(const std::string& bytes) {
  return open_tree_set(InputFile("set.haar", bytes.size(), [&](std::span<std::byte> to) {
    std::memcpy(to.data(), bytes.data(), to.size());
  }));
}

/// One map whose values rise evenly from left to right.
class RampSource : public MapSource {
public:
  explicit RampSource(int size) { m_info.size = size; }
  const SetInfo& info() const override { return m_info; }
  Map make(int /*column*/, int /*row*/) const override {
    Map map(m_info.size);
    for (int y = 0; y < map.size; ++y)
      for (int x = 0; x < map.size; ++x)
        map.set(x, y, Rgb::Constant(static_cast<float>(x)));
    return map;
  }

private:
  SetInfo m_info;
};

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
      {"version 0", [](Bytes& b) { put(b, 8, 0U); }},
      {"version 3", [](Bytes& b) { put(b, 8, 3U); }},
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

TEST_CASE("every flipped bit is noticed in both forms") {
  const TemporaryFolder folder;
  const std::string path = folder.file("set.haar");
  CompressOptions options = keep_all();
  for (const bool packed : {false, true}) {
    options.packed = packed;
    write_set(path, RandomSource(4, 1, 1), options);
    const std::string good = read_bytes(path);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      std::string bytes = good;
      bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
      INFO((packed ? "packed" : "mapped") << ", bit " << bit);
      CHECK_THROWS_AS(open_bytes(bytes), Error);
    }
  }
}

TEST_CASE("reserved and unused bits of a frame are refused") {
  const TemporaryFolder folder;
  const Parts parts(packed_example(folder));
  const std::string good = parts.assemble();
  const std::size_t text_frame = 160;
  REQUIRE_NOTHROW(open_bytes(good));
  for (const int bit : {3, 4}) {
    std::string bytes = good;
    bytes[text_frame + 4] = static_cast<char>(bytes[text_frame + 4] | 1 << bit);
    Parts::seal(bytes);
    CHECK_THROWS_AS(open_bytes(bytes), Error);
  }
}

namespace {

/// A full tree of a given depth. @param structure of every node above the last level
Parts full_tree(Parts parts, std::uint32_t levels, char inner, char last, std::size_t values) {
  std::uint32_t nodes = 0;
  for (std::uint32_t l = 0; l < levels; ++l)
    nodes += 1U << 2 * l;
  const std::uint32_t last_nodes = 1U << 2 * (levels - 1);
  parts.trees = 1;
  put(parts.header, 32 + 32, levels);
  put(parts.header, 32 + 48, 1U);
  const std::uint64_t index = 128 + (4 * (levels + 1) + 22ULL * nodes + 8 + 15) / 16 * 16;
  put(parts.header, 32 + 64, index);
  put(parts.header, 32 + 80, index + 40);
  put(parts.header, 32 + 16, index + 40 + get<std::uint64_t>(parts.header, 32 + 88));
  std::string record(20, '\0');
  put(record, 0, nodes);
  put(record, 4, 1.0F);
  parts.streams[0] = record;
  parts.streams[1] = std::string(levels, '\0');
  parts.streams[2] = std::string(nodes - last_nodes, inner) + std::string(last_nodes, last);
  for (std::size_t k = 3; k < parts.streams.size(); ++k)
    parts.streams[k] = std::string(values, k == 3 ? '\2' : '\0');
  return parts;
}

std::string refusal(const std::string& bytes) {
  try {
    open_bytes(bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST_CASE("trees of nodes without coefficients are refused before they are made") {
  const TemporaryFolder folder;
  const Parts example(packed_example(folder));
  const auto message = [&](std::uint32_t levels, char inner, char last, std::size_t values) {
    return refusal(full_tree(example, levels, inner, last, values).assemble());
  };
  const std::string empty = "no coefficient in their subtree";
  CHECK(message(13, 15, 0, 0).find(empty) != std::string::npos);
  CHECK(message(11, 15, 0, 0).find(empty) != std::string::npos);
  // Enough coefficients for the count of nodes, but all of them at the top.
  CHECK(message(11, '\x7f', 0, 3 * 349525).find(empty) != std::string::npos);
  // As many bytes, but in trees whose coefficients are there: refused for their checksums only.
  CHECK(message(10, '\x7f', '\x70', 3 * 349525).find("checksums") != std::string::npos);
  CHECK(message(9, 15, 0, 0).find("checksums") != std::string::npos);
}

TEST_CASE("frames whose blocks cannot hold their content size are refused") {
  const TemporaryFolder folder;
  const Parts parts(packed_example(folder));
  Parts bomb = full_tree(parts, 13, 15, 0, 0);
  std::string bytes = bomb.assemble();
  // The structure's frame is cut down to one block, which holds 128 KiB at most.
  const std::size_t block = 160 + get<std::uint32_t>(bytes, 24);
  std::size_t frame = block + 16 + 4 * 9;
  for (std::size_t i = 0; i < 2; ++i)
    frame += get<std::uint32_t>(bytes, block + 16 + 4 * i);
  const std::uint32_t size = get<std::uint32_t>(bytes, block + 16 + 8);
  std::string cut = bytes.substr(frame, 4) + '\xa0'; // one segment, four bytes of content size
  cut += std::string(4, '\0');
  put(cut, 5, 22369621U);
  cut += std::string("\x03\x00\x10\x0f", 4); // last block, a run of 128 KiB
  bytes.replace(frame, size, cut);
  put(bytes, block + 16 + 8, static_cast<std::uint32_t>(cut.size()));
  put(bytes, block + 4, static_cast<std::uint32_t>(bytes.size() - block));
  put(bytes, block + 8, checksum(bytes, block + 16, bytes.size() - block - 16));
  put(bytes, 16, static_cast<std::uint64_t>(bytes.size()));
  Parts::seal(bytes);
  CHECK(refusal(bytes).find("does not hold as many bytes") != std::string::npos);
}

TEST_CASE("a set of ramps, which compresses a thousandfold, comes back") {
  const TemporaryFolder folder;
  CompressOptions options = keep_all();
  write_set(folder.file("mapped.haar"), RampSource(512), options);
  options.packed = true;
  write_set(folder.file("packed.haar"), RampSource(512), options);
  const std::string mapped = read_bytes(folder.file("mapped.haar"));
  CHECK(read_bytes(folder.file("packed.haar")).size() < mapped.size() / 500);
  const TreeSet set = open_tree_set(folder.file("packed.haar"));
  CHECK(
      std::equal(mapped.begin(), mapped.end(), reinterpret_cast<const char*>(set.bytes().data())));
}

TEST_CASE("differences that halves round to zero make no nodes") {
  Map map(64);
  for (std::size_t i = 0; i < map.rgb.size(); ++i)
    map.rgb[i] = 1 + static_cast<float>(i % 7);
  map.rgb[0] = map.rgb[1] = map.rgb[2] = 1e20F;
  CompressReport report;
  const Tree tree = compress_map(map, keep_all(), report);
  CHECK(tree.links.size() == 6); // the squares that hold the bright pixel
}
