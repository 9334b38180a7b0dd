#include "file/file_format.h"
#include "file/tree_block.h"
#include "file/zstd_frame.h"

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/tree_set.h>

#include <algorithm>
#include <cassert>

namespace haarlight::wavelet {
namespace {

/// Larger blocks hardly shrink further; smaller ones need less memory.
constexpr std::uint64_t usual_block_bytes = std::uint64_t{1} << 22U;
static_assert(usual_block_bytes <= largest_block_bytes);

Tree copy_tree(const TreeSet& set, int column, int row) {
  const TreeView& view = set.tree(column, row);
  Tree tree;
  tree.levels = view.levels;
  tree.channels = view.channels;
  tree.type = view.type;
  tree.scale = view.scale;
  tree.mean = view.mean;
  const std::uint32_t* level_begin = view.links - (view.levels + 1);
  tree.level_begin.assign(level_begin, view.links);
  tree.links.assign(view.links, view.links + view.node_count);
  const std::size_t bytes =
      3 * static_cast<std::size_t>(view.channels) * coefficient_bytes(view.type) * view.node_count;
  tree.coefficients.assign(view.coefficients, view.coefficients + bytes + 8);
  return tree;
}

} // namespace

PackedSetWriter::PackedSetWriter(OutputFile& file, const SetInfo& info, int channels,
                                 CoefficientType type)
    : m_file(file), m_layout(std::make_unique<SetLayout>(info, channels, type)) {
  if (m_layout->text().size() > largest_packed_text)
    throw_output_error(file.path(), "cannot be packed: its text section exceeds 1 MiB");
  append_frame(std::as_bytes(std::span(m_layout->text())), m_text_frame);
  m_file.seek(sizeof(PackedHeader));
  m_file.write(m_text_frame.data(), m_text_frame.size());
}

PackedSetWriter::~PackedSetWriter() = default;

void PackedSetWriter::add(Tree tree) {
  const std::uint64_t bytes = m_layout->add(tree).size();
  if (m_pending_bytes + bytes > usual_block_bytes || m_pending.size() == largest_block_trees)
    close_block();
  m_pending.push_back(std::move(tree));
  m_pending_bytes += bytes;
}

void PackedSetWriter::close_block() {
  if (m_pending.empty())
    return;
  m_blocks.push_back(std::exchange(m_pending, {}));
  m_pending_bytes = 0;
  if (m_blocks.size() >= static_cast<std::size_t>(thread_count()))
    flush();
}

void PackedSetWriter::flush() {
  std::vector<EncodedBlock> packed(m_blocks.size());
  parallel_for(packed.size(), [&](std::size_t i) { packed[i] = encode_block(m_blocks[i]); });
  for (const EncodedBlock& block : packed) {
    m_empty_nodes += block.empty_nodes;
    m_file.write(block.bytes.data(), block.bytes.size());
  }
  if (m_empty_nodes > largest_empty_nodes)
    throw_output_error(m_file.path(), "cannot be packed: more than 2^18 nodes have no coefficient "
                                      "in their subtree");
  m_block_count += static_cast<std::uint32_t>(packed.size());
  m_blocks.clear();
}

void PackedSetWriter::finish() {
  close_block();
  flush();
  m_layout->finish();
  PackedHeader header = {};
  std::memcpy(header.magic, packed_magic, sizeof packed_magic);
  header.version = packed_version;
  header.header_bytes = sizeof(PackedHeader);
  header.file_bytes = m_file.position();
  header.text_frame_bytes = static_cast<std::uint32_t>(m_text_frame.size());
  header.blocks = m_block_count;
  header.mapped = m_layout->header();
  header.header_checksum = packed_header_checksum(header, m_text_frame);
  m_file.seek(0);
  m_file.write(&header, sizeof header);
  m_file.seek(header.file_bytes);
}

std::span<const std::byte> PackedSetWriter::mapped_header() const {
  return std::as_bytes(std::span(&m_layout->header(), 1));
}

void pack(const std::string& mapped_path, OutputFile& file, const Progress& progress) {
  const TreeSet set(mapped_path, Check::WhenUsed);
  const SetInfo& info = set.info();
  PackedSetWriter writer(file, info, set.channels(), set.coefficients());
  for (int row = 0; row < info.rows; ++row)
    for (int column = 0; column < info.columns; ++column) {
      writer.add(copy_tree(set, column, row));
      if (progress)
        progress(row * info.columns + column + 1, info.map_count());
    }
  writer.finish();
  const auto header = writer.mapped_header();
  if (std::memcmp(header.data(), set.bytes().data(), header.size()) != 0)
    throw_input_error(mapped_path,
                      "cannot be packed: its text section is not as version 1 writes it");
}

namespace {

class PackedFile {
public:
  explicit PackedFile(const InputFile& file) : m_bytes(file.bytes()), m_rules(file.path()) {
    read_header();
    read_text();
    find_blocks();
    check_sizes();
  }

  const FileHeader& mapped() const { return m_header.mapped; }
  SetInfo info() const { return info_from(mapped(), m_text); }
  std::size_t block_count() const { return m_blocks.size(); }
  /// Memory that decoding takes at most: trees and streams of the largest blocks.
  std::uint64_t decoding_bytes() const {
    return 3 * m_largest_block * static_cast<std::uint64_t>(thread_count());
  }
  const FileRules& rules() const { return m_rules; }

  DecodedBlock block(std::size_t i) const {
    const Block& b = m_blocks[i];
    return decode_block(m_bytes.subspan(b.offset, b.bytes), mapped(), m_rules, b.offset);
  }

private:
  struct Block {
    std::uint64_t offset;
    std::uint32_t bytes;
    std::uint32_t trees;
  };

  void read_header() {
    m_rules.require(begins_packed(m_bytes), 0,
                    "is no packed .haar file: it does not begin with 89 48 41 41 50 0d 0a 1a");
    m_rules.require(m_bytes.size() >= sizeof m_header, m_bytes.size(),
                    "truncated: the header of a packed .haar takes 160 bytes");
    std::memcpy(&m_header, m_bytes.data(), sizeof m_header);
    m_rules.require(std::memcmp(m_header.magic, packed_magic, sizeof packed_magic) == 0, 0,
                    "magic is not 89 48 41 41 50 0d 0a 1a");
    m_rules.require(m_header.version == 1 || m_header.version == packed_version, 8,
                    "version of the packed form is not 1 or 2");
    m_rules.require(m_header.text_frame_bytes <= m_bytes.size() - sizeof m_header, 24,
                    "text reaches beyond the end of the file");
    const auto frame = m_bytes.subspan(sizeof m_header, m_header.text_frame_bytes);
    m_rules.require(packed_header_checksum(m_header, frame) == m_header.header_checksum,
                    offsetof(PackedHeader, header_checksum),
                    "header checksum does not fit the header and the text");
    m_rules.require(m_header.header_bytes == sizeof m_header, 12, "header size is not 160");
    if (m_header.file_bytes != m_bytes.size())
      m_rules.refuse(16, "truncated or extended: the header says " +
                             std::to_string(m_header.file_bytes) + " bytes, the file has " +
                             std::to_string(m_bytes.size()));
    m_rules.check_header(mapped(), offsetof(PackedHeader, mapped));
    check_mapped_sections();
  }

  /// Index and text follow the trees, so that sizes and offsets determine each other.
  void check_mapped_sections() const {
    const FileHeader& h = mapped();
    const std::uint64_t trees = static_cast<std::uint64_t>(h.columns) * h.rows;
    const bool fits = h.index_offset <= h.text_offset && h.text_offset <= h.file_bytes &&
                      h.text_offset - h.index_offset == trees * sizeof(IndexEntry) &&
                      h.file_bytes - h.text_offset == h.text_bytes;
    m_rules.require(fits, offsetof(PackedHeader, mapped) + 64,
                    "sections of the mapped file do not follow each other");
  }

  void read_text() {
    constexpr std::uint64_t start = sizeof(PackedHeader);
    m_rules.require(mapped().text_bytes <= largest_packed_text, 120, "text exceeds 1 MiB");
    const auto frame = m_bytes.subspan(start, m_header.text_frame_bytes);
    m_rules.require(frame_content_size(frame) == mapped().text_bytes, start,
                    "text does not have the length that the header says");
    m_text.resize(mapped().text_bytes);
    m_rules.require(read_frame(frame, std::as_writable_bytes(std::span(m_text))), start,
                    "text is damaged");
  }

  void find_blocks() {
    std::uint64_t next = sizeof(PackedHeader) + m_header.text_frame_bytes;
    std::uint64_t trees = 0;
    for (std::uint32_t i = 0; i < m_header.blocks; ++i) {
      BlockHeader block = {};
      m_rules.require(sizeof block <= m_bytes.size() - next, next,
                      "block reaches beyond the end of the file");
      std::memcpy(&block, m_bytes.data() + next, sizeof block);
      m_rules.require(block.bytes >= sizeof block && block.bytes <= m_bytes.size() - next, next + 4,
                      "block reaches beyond the end of the file");
      m_rules.require(block.trees >= 1 && block.trees <= largest_block_trees, next,
                      "block holds no trees, or more than 4096");
      m_blocks.push_back({next, block.bytes, block.trees});
      next += block.bytes;
      trees += block.trees;
    }
    m_rules.require(next == m_bytes.size(), next, "file does not end with its last block");
    m_rules.require(trees == static_cast<std::uint64_t>(mapped().columns) * mapped().rows, 28,
                    "blocks do not hold as many trees as the set has");
  }

  /// Before anything is decoded: the trees take as many bytes as the mapped header leaves them, and
  /// there are not more nodes than coefficients can account for. Each coefficient present makes the
  /// nodes on its way from the root non-empty, L at most.
  void check_sizes() {
    std::uint64_t mapped_bytes = align_up(sizeof(FileHeader));
    std::uint64_t nodes = 0;
    std::uint64_t values = 0;
    for (const Block& b : m_blocks) {
      const BlockSizes sizes =
          scan_block(m_bytes.subspan(b.offset, b.bytes), mapped(), m_rules, b.offset);
      mapped_bytes += sizes.mapped_bytes;
      nodes += sizes.nodes;
      values += sizes.values;
      m_largest_block = std::max(m_largest_block, sizes.mapped_bytes);
      m_rules.require(mapped_bytes <= mapped().index_offset, 32 + 64,
                      "trees take more bytes than the header says");
    }
    m_rules.require(mapped_bytes == mapped().index_offset, 32 + 64,
                    "trees take fewer bytes than the header says");
    m_rules.require(nodes <= mapped().levels * values + largest_empty_nodes, 28,
                    empty_nodes_message);
  }

  std::span<const std::byte> m_bytes;
  FileRules m_rules;
  PackedHeader m_header = {};
  std::string m_text;
  std::vector<Block> m_blocks;
  std::uint64_t m_largest_block = 0;
};

/// Decodes some blocks at a time, from several threads, and passes their trees on in order.
void write_trees(const PackedFile& packed, TreeSink& sink, const Progress& progress) {
  std::vector<DecodedBlock> batch(static_cast<std::size_t>(thread_count()));
  int done = 0;
  std::uint64_t empty_nodes = 0;
  const int total = packed.info().map_count();
  for (std::size_t begin = 0; begin < packed.block_count(); begin += batch.size()) {
    const std::size_t filled = std::min(batch.size(), packed.block_count() - begin);
    parallel_for(filled, [&](std::size_t i) { batch[i] = packed.block(begin + i); });
    for (std::size_t i = 0; i < filled; ++i) {
      empty_nodes += batch[i].empty_nodes;
      packed.rules().require(empty_nodes <= largest_empty_nodes, 28, empty_nodes_message);
      for (Tree& tree : batch[i].trees) {
        sink.add(std::move(tree));
        if (progress)
          progress(++done, total);
      }
      batch[i] = {};
    }
  }
  sink.finish();
}

/// The mapped form, written into memory of its size.
class MemoryWriter : public TreeSink {
public:
  MemoryWriter(std::span<std::byte> bytes, const PackedFile& packed)
      : m_bytes(bytes), m_layout(packed.info(), static_cast<int>(packed.mapped().channels),
                                 static_cast<CoefficientType>(packed.mapped().coefficient_type)) {}

  void add(Tree tree) override { append(m_layout.add(tree)); }

  void finish() override {
    m_layout.finish();
    append(std::as_bytes(std::span(m_layout.index())));
    append(std::as_bytes(std::span(m_layout.text())));
    m_position = 0;
    append(std::as_bytes(std::span(&m_layout.header(), 1)));
  }

  const FileHeader& header() const { return m_layout.header(); }

private:
  /// Sizes of trees are checked, that of the text is not: it may be laid out in another way.
  void append(std::span<const std::byte> bytes) {
    const std::size_t fits = std::min(bytes.size(), m_bytes.size() - m_position);
    std::copy_n(bytes.begin(), fits, m_bytes.begin() + static_cast<std::ptrdiff_t>(m_position));
    m_position += fits;
  }

  std::span<std::byte> m_bytes;
  SetLayout m_layout;
  std::size_t m_position = align_up(sizeof(FileHeader));
};

void check_header(const PackedFile& packed, const void* written) {
  packed.rules().require(std::memcmp(written, &packed.mapped(), sizeof(FileHeader)) == 0, 32,
                         "trees and text do not have the checksums of the header");
}

/// The mapped form of a packed file, in memory.
InputFile unpacked(const InputFile& file) {
  const PackedFile packed(file);
  const std::uint64_t needed = packed.mapped().file_bytes + packed.decoding_bytes();
  if (needed > available_memory())
    packed.rules().refuse(
        32 + 16, "takes " + std::to_string(needed >> 20U) + " MiB of memory to unpack, of which " +
                     std::to_string(available_memory() >> 20U) + " MiB are available");
  return {file.path(), packed.mapped().file_bytes, [&](std::span<std::byte> bytes) {
            MemoryWriter writer(bytes, packed);
            write_trees(packed, writer, {});
            check_header(packed, &writer.header());
          }};
}

} // namespace

std::uint64_t packed_header_checksum(const PackedHeader& header,
                                     std::span<const std::byte> text_frame) {
  const auto fields =
      std::as_bytes(std::span(&header, 1)).first(offsetof(PackedHeader, header_checksum));
  std::vector<std::byte> covered(fields.begin(), fields.end());
  if (header.version != 1)
    covered.insert(covered.end(), text_frame.begin(), text_frame.end());
  return hash_bytes(covered);
}

std::optional<FileForm> file_form(const InputFile& file) {
  const auto bytes = file.beginning(sizeof packed_magic);
  if (begins_packed(bytes))
    return FileForm::Packed;
  if (begins_mapped(bytes))
    return FileForm::Mapped;
  return std::nullopt;
}

std::optional<FileForm> file_form(const std::string& path) { return file_form(InputFile(path)); }

void unpack(const std::string& packed_path, OutputFile& file, const Progress& progress) {
  const InputFile input(packed_path);
  const PackedFile packed(input);
  const FileHeader& mapped = packed.mapped();
  TreeSetWriter writer(file, packed.info(), static_cast<int>(mapped.channels),
                       static_cast<CoefficientType>(mapped.coefficient_type));
  write_trees(packed, writer, progress);
  check_header(packed, writer.header().data());
}

TreeSet open_tree_set(InputFile file, Check check) {
  return file_form(file) == FileForm::Packed ? TreeSet(unpacked(file), check)
                                             : TreeSet(std::move(file), check);
}

TreeSet open_tree_set(const std::string& path, Check check) {
  return open_tree_set(InputFile(path), check);
}

} // namespace haarlight::wavelet
