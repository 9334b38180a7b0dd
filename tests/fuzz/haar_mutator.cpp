#include "haar_mutator.h"

#include <file/file_format.h>
#include <file/tree_block.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <random>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace haarlight::fuzzing {
namespace {

using namespace wavelet;
using Bytes = std::vector<std::byte>;
using Random = std::minstd_rand;

/// Streams that claim more are left alone.
constexpr std::uint64_t largest_stream = 1U << 16U;

std::uint8_t* raw(std::byte* bytes) { return reinterpret_cast<std::uint8_t*>(bytes); }

template <class T>
T load(std::span<const std::byte> bytes, std::size_t offset) {
  T value = {};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <class T>
void store(std::span<std::byte> bytes, std::size_t offset, const T& value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// Changes some bytes without a change of their number.
void mutate_in_place(std::span<std::byte> bytes) {
  if (bytes.empty())
    return;
  Bytes copy(bytes.begin(), bytes.end());
  const std::size_t size = LLVMFuzzerMutate(raw(copy.data()), copy.size(), copy.size());
  std::copy_n(copy.begin(), std::min(size, bytes.size()), bytes.begin());
}

/// Changes some bytes and maybe their number.
void mutate_freely(Bytes& bytes) {
  const std::size_t size = bytes.size();
  bytes.resize(size + 16);
  bytes.resize(LLVMFuzzerMutate(raw(bytes.data()), size, bytes.size()));
}

/// A section of a mapped file that lies within it, or nothing.
std::span<std::byte> section(std::span<std::byte> file, std::uint64_t offset, std::uint64_t size) {
  if (offset > file.size() || size > file.size() - offset)
    return {};
  return file.subspan(offset, size);
}

std::span<std::byte> index_of(std::span<std::byte> file, const FileHeader& header) {
  return section(file, header.index_offset,
                 std::uint64_t{header.columns} * header.rows * sizeof(IndexEntry));
}

std::span<std::byte> tree_of(std::span<std::byte> file, const FileHeader& header,
                             const IndexEntry& entry) {
  if (header.levels > largest_levels || (header.channels != 1 && header.channels != 3))
    return {};
  return section(file, entry.offset,
                 tree_size(entry.node_count, header.levels, header.channels,
                           header.coefficient_type == 0 ? 2 : 4));
}

/// Checksums of trees, index, text and header, in this order as each covers the one before.
void mend_mapped(std::span<std::byte> file) {
  if (file.size() < sizeof(FileHeader))
    return;
  auto header = load<FileHeader>(file, 0);
  const auto index = index_of(file, header);
  for (std::size_t at = 0; at < index.size(); at += sizeof(IndexEntry)) {
    auto entry = load<IndexEntry>(index, at);
    if (const auto tree = tree_of(file, header, entry); !tree.empty())
      entry.checksum = hash_bytes(tree);
    store(index, at, entry);
  }
  header.file_bytes = file.size();
  header.index_checksum = hash_bytes(index);
  header.text_checksum = hash_bytes(section(file, header.text_offset, header.text_bytes));
  store(file, 0, header);
  header.header_checksum = hash_bytes(file.first(offsetof(FileHeader, header_checksum)));
  store(file, 0, header);
}

void mutate_text(Bytes& file) {
  auto header = load<FileHeader>(file, 0);
  if (section(file, header.text_offset, header.text_bytes).empty())
    return;
  Bytes text(file.begin() + static_cast<std::ptrdiff_t>(header.text_offset), file.end());
  mutate_freely(text);
  header.text_bytes = text.size();
  file.resize(header.text_offset);
  file.insert(file.end(), text.begin(), text.end());
  store(file, 0, header);
}

/// The parts of a packed file, its frames decompressed.
struct PackedParts {
  PackedHeader header = {};
  Bytes text;
  struct Block {
    std::uint32_t trees = 0;
    std::vector<Bytes> streams;
  };
  std::vector<Block> blocks;

  static std::optional<PackedParts> parse(std::span<const std::byte> file);
  Bytes assemble();

private:
  void match_mapped_header(std::span<const Bytes> block_bytes);
};

/// Contexts of zstd, used again: allocating them takes longer than such small frames.
struct FrameCoder {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> compressor{ZSTD_createCCtx(), ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> decompressor{ZSTD_createDCtx(),
                                                                    ZSTD_freeDCtx};
};

const FrameCoder& frame_coder() {
  static const FrameCoder coder;
  return coder;
}

std::optional<Bytes> decompressed(std::span<const std::byte> frame) {
  const auto size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size > largest_stream) // includes the codes of errors
    return std::nullopt;
  Bytes content(size);
  if (ZSTD_decompressDCtx(frame_coder().decompressor.get(), content.data(), size, frame.data(),
                          frame.size()) != size)
    return std::nullopt;
  return content;
}

Bytes compressed(const Bytes& content) {
  Bytes frame(ZSTD_compressBound(content.size()));
  frame.resize(ZSTD_compressCCtx(frame_coder().compressor.get(), frame.data(), frame.size(),
                                 content.data(), content.size(), 1));
  return frame;
}

std::size_t streams_of(const FileHeader& header) {
  return stream_count(header.channels == 1 ? 1 : 3, header.coefficient_type == 0
                                                        ? CoefficientType::Half
                                                        : CoefficientType::Float);
}

std::optional<PackedParts> PackedParts::parse(std::span<const std::byte> file) {
  PackedParts parts;
  if (file.size() < sizeof parts.header)
    return std::nullopt;
  parts.header = load<PackedHeader>(file, 0);
  file = file.subspan(sizeof parts.header);
  const auto take = [&](std::uint64_t size) {
    const auto part = file.first(std::min<std::uint64_t>(size, file.size()));
    file = file.subspan(part.size());
    return part;
  };
  auto text = decompressed(take(parts.header.text_frame_bytes));
  if (!text)
    return std::nullopt;
  parts.text = std::move(*text);
  const std::size_t count = streams_of(parts.header.mapped);
  while (file.size() >= sizeof(BlockHeader) + 4 * count) {
    Block block;
    block.trees = load<BlockHeader>(take(sizeof(BlockHeader)), 0).trees;
    const auto sizes = take(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
      auto stream = decompressed(take(load<std::uint32_t>(sizes, 4 * i)));
      if (!stream)
        return std::nullopt;
      block.streams.push_back(std::move(*stream));
    }
    parts.blocks.push_back(std::move(block));
  }
  return parts;
}

Bytes block_bytes_of(const PackedParts::Block& block) {
  Bytes bytes(sizeof(BlockHeader) + 4 * block.streams.size());
  for (std::size_t i = 0; i < block.streams.size(); ++i) {
    const Bytes frame = compressed(block.streams[i]);
    store(bytes, sizeof(BlockHeader) + 4 * i, static_cast<std::uint32_t>(frame.size()));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  BlockHeader header = {};
  header.trees = block.trees;
  header.bytes = static_cast<std::uint32_t>(bytes.size());
  header.checksum = hash_bytes(std::span(bytes).subspan(sizeof header));
  store(bytes, 0, header);
  return bytes;
}

/// Where the blocks can be decoded, the header becomes the one that the mapped file of these trees
/// has.
void PackedParts::match_mapped_header(std::span<const Bytes> block_bytes) {
  FileHeader& mapped = header.mapped;
  try {
    mapped.header_checksum = hash_bytes(
        std::as_bytes(std::span(&mapped, 1)).first(offsetof(FileHeader, header_checksum)));
    const FileRules rules("");
    rules.check_header(mapped, 0);
    FileHeader roomy = mapped; // the offsets are found here
    roomy.index_offset = largest_stream * 64;
    const std::string words(reinterpret_cast<const char*>(text.data()), text.size());
    SetLayout layout(info_from(mapped, words), static_cast<int>(mapped.channels),
                     static_cast<CoefficientType>(mapped.coefficient_type));
    std::uint64_t trees = 0;
    for (const Bytes& block : block_bytes) {
      const DecodedBlock decoded = decode_block(block, roomy, rules, 0);
      for (const Tree& tree : decoded.trees) {
        layout.add(tree);
        ++trees;
      }
    }
    if (trees != std::uint64_t{mapped.columns} * mapped.rows)
      return;
    layout.finish();
    mapped = layout.header();
  } catch (const Error&) { // NOLINT(bugprone-empty-catch): the file stays one to refuse
  }
}

Bytes PackedParts::assemble() {
  std::vector<Bytes> block_bytes;
  for (const Block& block : blocks)
    block_bytes.push_back(block_bytes_of(block));
  match_mapped_header(block_bytes);
  const Bytes frame = compressed(text);
  Bytes file(sizeof header);
  file.insert(file.end(), frame.begin(), frame.end());
  for (const Bytes& block : block_bytes)
    file.insert(file.end(), block.begin(), block.end());
  header.text_frame_bytes = static_cast<std::uint32_t>(frame.size());
  header.blocks = static_cast<std::uint32_t>(blocks.size());
  header.file_bytes = file.size();
  store(file, 0, header);
  header.header_checksum =
      hash_bytes(std::span(file).first(offsetof(PackedHeader, header_checksum)));
  store(file, 0, header);
  return file;
}

/// In place of a frame, a change of what it holds.
void mutate_parts(PackedParts& parts, Random& random) {
  const auto action = random() % 16;
  if (action == 0 || parts.blocks.empty()) {
    mutate_freely(parts.text);
    return;
  }
  if (action == 1) {
    mutate_in_place(std::as_writable_bytes(std::span(&parts.header.mapped, 1)));
    return;
  }
  PackedParts::Block& block = parts.blocks[random() % parts.blocks.size()];
  if (action == 2) {
    mutate_in_place(std::as_writable_bytes(std::span(&block.trees, 1)));
    return;
  }
  Bytes& stream = block.streams[random() % block.streams.size()];
  if (action < 6)
    mutate_freely(stream);
  else
    mutate_in_place(stream);
}

std::size_t put_back(const Bytes& file, std::uint8_t* data, std::size_t size,
                     std::size_t max_size) {
  if (file.size() > max_size)
    return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, file.data(), file.size());
  return file.size();
}

} // namespace

std::size_t mutate_mapped(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed) {
  Random random(seed);
  const auto action = random() % 16;
  if (size < sizeof(FileHeader) || action == 0)
    return LLVMFuzzerMutate(data, size, max_size);
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  Bytes file(bytes, bytes + size);
  const auto header = load<FileHeader>(file, 0);
  const auto index = index_of(file, header);
  if (action == 1) {
    mutate_freely(file);
  } else if (action < 4) {
    mutate_in_place(std::span(file).first(sizeof header));
  } else if (action < 7) {
    mutate_in_place(index);
  } else if (action < 9) {
    mutate_text(file);
  } else if (!index.empty()) {
    const std::size_t count = index.size() / sizeof(IndexEntry);
    const auto entry = load<IndexEntry>(index, random() % count * sizeof(IndexEntry));
    mutate_in_place(tree_of(file, header, entry));
  }
  mend_mapped(file);
  return put_back(file, data, size, max_size);
}

std::size_t mutate_packed(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed) {
  Random random(seed);
  auto parts = PackedParts::parse(std::as_bytes(std::span(data, size)));
  if (!parts || random() % 16 == 0)
    return LLVMFuzzerMutate(data, size, max_size);
  mutate_parts(*parts, random);
  return put_back(parts->assemble(), data, size, max_size);
}

std::size_t mutate_either(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed) {
  return begins_packed(std::as_bytes(std::span(data, size)))
             ? mutate_packed(data, size, max_size, seed)
             : mutate_mapped(data, size, max_size, seed);
}

} // namespace haarlight::fuzzing
