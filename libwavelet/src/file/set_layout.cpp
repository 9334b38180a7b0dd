#include "file/set_layout.h"

#include <wavelet/file/input_file.h>

#include <bit>
#include <cassert>

namespace haarlight::wavelet {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

template <class T>
void append(std::vector<std::byte>& bytes, const T* values, std::size_t count) {
  const auto* p = reinterpret_cast<const std::byte*>(values);
  bytes.insert(bytes.end(), p, p + count * sizeof(T));
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

std::string text_section(const SetInfo& info) {
  return "frame=" + info.frame + "\nunits=" + info.units + "\n" + info.provenance.text();
}

} // namespace

SetInfo info_from(const FileHeader& h, const std::string& text) {
  SetInfo info;
  info.kind = static_cast<SetKind>(h.kind);
  info.size = 1 << h.levels;
  info.columns = static_cast<int>(h.columns);
  info.rows = static_cast<int>(h.rows);
  info.rolls = static_cast<int>(h.rolls);
  info.fold = static_cast<Fold>(h.fold);
  info.cosine = (h.flags & flag_cosine) != 0;
  info.world_frame = (h.flags & flag_world_frame) != 0;
  const Provenance lines = Provenance::parse(text);
  for (const auto& [name, value] : lines.entries()) {
    if (name == "frame")
      info.frame = value;
    else if (name == "units")
      info.units = value;
    else
      info.provenance.set(name, value);
  }
  return info;
}

SetLayout::SetLayout(const SetInfo& info, int channels, CoefficientType type)
    : m_header(describe(info, channels, type)), m_text(text_section(info)),
      m_position(align_up(sizeof(FileHeader))) {}

std::vector<std::byte> SetLayout::add(const Tree& tree) {
  const auto type = static_cast<CoefficientType>(m_header.coefficient_type);
  assert(tree.levels == static_cast<int>(m_header.levels) && tree.type == type &&
         tree.channels == static_cast<int>(m_header.channels));
  const std::size_t nodes = tree.links.size();
  std::vector<std::byte> bytes;
  bytes.reserve(tree_size(nodes, m_header.levels, m_header.channels, coefficient_bytes(type)));
  append(bytes, tree.level_begin.data(), tree.level_begin.size());
  append(bytes, tree.links.data(), nodes);
  append(bytes, tree.coefficients.data(), 3 * m_header.channels * nodes * coefficient_bytes(type));
  bytes.resize(align_up(bytes.size() + tree_padding));
  m_index.push_back({m_position,
                     hash_bytes(bytes),
                     static_cast<std::uint32_t>(nodes),
                     tree.scale,
                     {tree.mean[0], tree.mean[1], tree.mean[2]},
                     0});
  m_position += bytes.size();
  return bytes;
}

void SetLayout::finish() {
  assert(m_index.size() == static_cast<std::size_t>(m_header.columns) * m_header.rows);
  const auto index_bytes = std::as_bytes(std::span(m_index));
  m_header.index_offset = m_position;
  m_header.index_checksum = hash_bytes(index_bytes);
  m_header.text_offset = m_position + index_bytes.size();
  m_header.text_bytes = m_text.size();
  m_header.text_checksum = hash_bytes(std::as_bytes(std::span(m_text)));
  m_header.file_bytes = m_header.text_offset + m_text.size();
  m_header.header_checksum = hash_bytes(
      std::as_bytes(std::span(&m_header, 1)).first(offsetof(FileHeader, header_checksum)));
}

} // namespace haarlight::wavelet
