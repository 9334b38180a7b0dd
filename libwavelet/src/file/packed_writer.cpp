#include "file/packed_layout.h"
#include "file/set_layout.h"
#include "file/tree_block.h"
#include "file/zstd_frame.h"

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/packed_set.h>

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

} // namespace haarlight::wavelet
