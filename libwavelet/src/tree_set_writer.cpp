#include "file_layout.h"

#include <wavelet/tree_set.h>

#include <bit>
#include <cassert>
#include <cstring>

namespace haarlight::wavelet {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

template <class T>
void append(std::vector<std::byte>& bytes, const T* values, std::size_t count) {
  const auto* p = reinterpret_cast<const std::byte*>(values);
  bytes.insert(bytes.end(), p, p + count * sizeof(T));
}

std::string text_section(const SetInfo& info) {
  return "frame=" + info.frame + "\nunits=" + info.units + "\n" + info.provenance.text();
}

FileHeader describe(const SetInfo& info, int channels, CoefficientType type) {
  FileHeader header = {};
  std::memcpy(header.magic, file_magic, sizeof file_magic);
  header.version = file_version;
  header.header_bytes = sizeof(FileHeader);
  header.kind = static_cast<std::uint32_t>(info.kind);
  header.domain = domain_octahedral;
  header.levels = static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(info.size)));
  header.channels = static_cast<std::uint32_t>(channels);
  header.coefficient_type = static_cast<std::uint32_t>(type);
  header.fold = static_cast<std::uint32_t>(info.fold);
  header.columns = static_cast<std::uint32_t>(info.columns);
  header.rows = static_cast<std::uint32_t>(info.rows);
  header.rolls = static_cast<std::uint32_t>(info.rolls);
  header.flags = (info.cosine ? flag_cosine : 0U) | (info.world_frame ? flag_world_frame : 0U);
  return header;
}

} // namespace

TreeSetWriter::TreeSetWriter(OutputFile& file, const SetInfo& info, int channels,
                             CoefficientType type)
    : m_file(file), m_info(info), m_channels(channels), m_type(type) {
  m_entries.reserve(static_cast<std::size_t>(info.map_count()));
  m_file.seek(align_up(sizeof(FileHeader)));
}

void TreeSetWriter::add(const Tree& tree) {
  assert((1 << tree.levels) == m_info.size && tree.channels == m_channels && tree.type == m_type);
  const std::size_t nodes = tree.links.size();
  const std::size_t coefficient_count = 3 * static_cast<std::size_t>(m_channels) * nodes;
  std::vector<std::byte> bytes;
  append(bytes, tree.level_begin.data(), tree.level_begin.size());
  append(bytes, tree.links.data(), nodes);
  append(bytes, tree.coefficients.data(), coefficient_count * coefficient_bytes(m_type));
  bytes.resize(align_up(bytes.size() + tree_padding));
  Entry entry = {
      m_file.position(), hash_bytes(bytes), static_cast<std::uint32_t>(nodes), tree.scale, {}};
  for (int c = 0; c < 3; ++c)
    entry.mean[c] = tree.mean[c];
  m_entries.push_back(entry);
  m_file.write(bytes.data(), bytes.size());
}

void TreeSetWriter::finish() {
  assert(m_entries.size() == static_cast<std::size_t>(m_info.map_count()));
  FileHeader header = describe(m_info, m_channels, m_type);
  std::vector<IndexEntry> index;
  for (const Entry& e : m_entries)
    index.push_back(
        {e.offset, e.checksum, e.node_count, e.scale, {e.mean[0], e.mean[1], e.mean[2]}, 0});
  const auto index_bytes = std::as_bytes(std::span(index));
  header.index_offset = m_file.position();
  header.index_checksum = hash_bytes(index_bytes);
  m_file.write(index_bytes.data(), index_bytes.size());
  const std::string text = text_section(m_info);
  header.text_offset = m_file.position();
  header.text_bytes = text.size();
  header.text_checksum = hash_bytes(std::as_bytes(std::span(text)));
  m_file.write(text.data(), text.size());
  header.file_bytes = m_file.position();
  header.header_checksum =
      hash_bytes(std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_checksum)));
  unsigned char padded[128] = {};
  static_assert(sizeof padded == (sizeof(FileHeader) + 15) / 16 * 16);
  std::memcpy(padded, &header, sizeof header);
  m_file.seek(0);
  m_file.write(padded, sizeof padded);
  m_file.seek(header.file_bytes);
}

} // namespace haarlight::wavelet
