#include "packed_layout.h"
#include "set_layout.h"
#include "tree_block.h"
#include "zstd_frame.h"

#include <wavelet/error.h>
#include <wavelet/packed_set.h>
#include <wavelet/parallel.h>

#include <algorithm>
#include <filesystem>

namespace haarlight::wavelet {
namespace {

class PackedFile {
public:
  explicit PackedFile(const std::string& path)
      : m_file(path), m_bytes(m_file.bytes()), m_rules(path) {
    read_header();
    read_text();
    find_blocks();
  }

  const FileHeader& mapped() const { return m_header.mapped; }
  SetInfo info() const { return info_from(mapped(), m_text); }
  std::size_t block_count() const { return m_blocks.size(); }
  std::uint32_t block_trees(std::size_t i) const { return m_blocks[i].trees; }
  const FileRules& rules() const { return m_rules; }

  std::vector<Tree> block(std::size_t i) const {
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
    m_rules.require(m_header.version == packed_version, 8, "version of the packed form is not 1");
    m_rules.require(hash_bytes(m_bytes.first(offsetof(PackedHeader, header_checksum))) ==
                        m_header.header_checksum,
                    offsetof(PackedHeader, header_checksum),
                    "header checksum does not fit the header");
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
    m_rules.require(m_header.text_frame_bytes <= m_bytes.size() - start, 24,
                    "text reaches beyond the end of the file");
    m_rules.require(mapped().text_bytes <= largest_packed_text, 120, "text exceeds 1 MiB");
    const auto frame = m_bytes.subspan(start, m_header.text_frame_bytes);
    m_rules.require(frame_claims(frame, mapped().text_bytes), start,
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

  InputFile m_file;
  std::span<const std::byte> m_bytes;
  FileRules m_rules;
  PackedHeader m_header = {};
  std::string m_text;
  std::vector<Block> m_blocks;
};

/// A tree's bytes in the mapped form.
std::uint64_t mapped_bytes(const Tree& tree) {
  return tree_size(tree.links.size(), static_cast<std::uint64_t>(tree.levels),
                   static_cast<std::uint64_t>(tree.channels), coefficient_bytes(tree.type));
}

/// Decodes some blocks at a time, from several threads, and passes their trees on in order.
void write_trees(const PackedFile& packed, TreeSink& sink, const Progress& progress) {
  std::vector<std::vector<Tree>> batch(static_cast<std::size_t>(thread_count()));
  int done = 0;
  std::uint64_t position = align_up(sizeof(FileHeader));
  const int total = packed.info().map_count();
  for (std::size_t begin = 0; begin < packed.block_count(); begin += batch.size()) {
    const std::size_t filled = std::min(batch.size(), packed.block_count() - begin);
    parallel_for(filled, [&](std::size_t i) { batch[i] = packed.block(begin + i); });
    for (std::size_t i = 0; i < filled; ++i)
      for (Tree& tree : batch[i]) {
        position += mapped_bytes(tree);
        packed.rules().require(position <= packed.mapped().index_offset, 32 + 64,
                               "trees take more bytes than the header says");
        sink.add(std::move(tree));
        if (progress)
          progress(++done, total);
      }
  }
  sink.finish();
}

} // namespace

std::optional<FileForm> file_form(const std::string& path) {
  const InputFile file(path);
  if (begins_packed(file.bytes()))
    return FileForm::Packed;
  if (begins_mapped(file.bytes()))
    return FileForm::Mapped;
  return std::nullopt;
}

void unpack(const std::string& packed_path, OutputFile& file, const Progress& progress) {
  const PackedFile packed(packed_path);
  const FileHeader& mapped = packed.mapped();
  TreeSetWriter writer(file, packed.info(), static_cast<int>(mapped.channels),
                       static_cast<CoefficientType>(mapped.coefficient_type));
  write_trees(packed, writer, progress);
  packed.rules().require(std::memcmp(writer.header().data(), &mapped, sizeof mapped) == 0, 32,
                         "trees and text do not have the checksums of the header");
}

TreeSet open_tree_set(const std::string& path, Check check) {
  if (file_form(path) != FileForm::Packed)
    return TreeSet(path, check);
  std::error_code none;
  const std::string folder = std::filesystem::temp_directory_path(none).string();
  OutputFile file((folder.empty() ? "/tmp" : folder) + '/' + base_name(path) + ".unpacked");
  unpack(path, file);
  return TreeSet(InputFile(file.temporary(), path), check);
}

} // namespace haarlight::wavelet
