#include "file/file_format.h"

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/tree_set.h>

#include <algorithm>
#include <cstring>

namespace haarlight::wavelet {
namespace {

/// Finds the sections of one file, and refuses it where they are not what they should be.
class Sections {
public:
  explicit Sections(const InputFile& file) : m_file(file), m_rules(file.path()) {}

  FileHeader header() const {
    FileHeader h = {};
    const auto bytes = m_file.beginning(align_up(sizeof h));
    m_rules.require(!begins_packed(bytes), 0,
                    "is packed; maps2haar --unpack makes the form that can be used in place");
    m_rules.require(bytes.size() >= 8 && std::memcmp(bytes.data(), file_magic, 8) == 0, 0,
                    "is no .haar file: it does not begin with the magic 89 48 41 41 52 0d 0a 1a");
    m_rules.require(bytes.size() == align_up(sizeof h), bytes.size(),
                    "truncated: a .haar header takes 128 bytes");
    std::memcpy(&h, bytes.data(), sizeof h);
    m_rules.check_header(h, 0);
    for (std::size_t i = sizeof h; i < align_up(sizeof h); ++i)
      m_rules.require(bytes[i] == std::byte{0}, i, "padding after the header is not 0");
    if (h.file_bytes != m_file.size())
      m_rules.refuse(16, "truncated or extended: the header says " + std::to_string(h.file_bytes) +
                             " bytes, the file has " + std::to_string(m_file.size()));
    return h;
  }

  std::vector<IndexEntry> index(const FileHeader& h) const {
    const std::uint64_t count = static_cast<std::uint64_t>(h.columns) * h.rows;
    check_section(h.index_offset, count * sizeof(IndexEntry), 64, "index");
    const auto bytes = m_file.part(h.index_offset, count * sizeof(IndexEntry));
    m_rules.require(hash_bytes(bytes) == h.index_checksum, h.index_offset,
                    "index checksum does not fit the index");
    std::vector<IndexEntry> entries(count);
    std::memcpy(entries.data(), bytes.data(), bytes.size());
    std::uint64_t next = align_up(sizeof h);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t at = h.index_offset + i * sizeof(IndexEntry);
      m_rules.check_entry(entries[i], at);
      m_rules.require(entries[i].offset == next, at,
                      "tree does not begin where the one before it ends");
      next += tree_bytes(h, entries[i]);
    }
    m_rules.require(next == h.index_offset, 64, "index does not begin where the last tree ends");
    return entries;
  }

  std::string text(const FileHeader& h) const {
    check_section(h.text_offset, h.text_bytes, 80, "text");
    const auto bytes = m_file.part(h.text_offset, h.text_bytes);
    m_rules.require(hash_bytes(bytes) == h.text_checksum, h.text_offset,
                    "text checksum does not fit the text");
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  /// A tree that check_tree() must read before it is used.
  TreeView tree(const FileHeader& h, const IndexEntry& entry) const {
    check_section(entry.offset, tree_bytes(h, entry), entry.offset, "tree");
    const std::byte* start = m_file.place(entry.offset);
    TreeView view;
    view.levels = static_cast<int>(h.levels);
    view.channels = static_cast<int>(h.channels);
    view.type = static_cast<CoefficientType>(h.coefficient_type);
    view.node_count = entry.node_count;
    view.scale = entry.scale;
    view.mean = {entry.mean[0], entry.mean[1], entry.mean[2]};
    view.links = reinterpret_cast<const std::uint32_t*>(start) + h.levels + 1;
    view.coefficients = reinterpret_cast<const std::byte*>(view.links + entry.node_count);
    return view;
  }

private:
  static std::uint64_t tree_bytes(const FileHeader& h, const IndexEntry& entry) {
    const auto type = static_cast<CoefficientType>(h.coefficient_type);
    return tree_size(entry.node_count, h.levels, h.channels, coefficient_bytes(type));
  }

  void check_section(std::uint64_t offset, std::uint64_t size, std::uint64_t field,
                     const char* name) const {
    if (offset > m_file.size() || size > m_file.size() - offset)
      m_rules.refuse(field, std::string(name) + " reaches beyond the end of the file");
  }

  const InputFile& m_file;
  FileRules m_rules;
};

} // namespace

TreeSet::TreeSet(const std::string& path, Check check) : TreeSet(InputFile(path), check) {}

TreeSet::TreeSet(InputFile file, Check check) : m_file(std::move(file)) {
  const Sections sections(m_file);
  const FileHeader header = sections.header();
  const std::vector<IndexEntry> index = sections.index(header);
  m_info = info_from(header, sections.text(header));
  m_levels = static_cast<int>(header.levels);
  m_channels = static_cast<int>(header.channels);
  m_type = static_cast<CoefficientType>(header.coefficient_type);
  m_trees.reserve(index.size());
  for (const IndexEntry& entry : index) {
    m_trees.push_back(sections.tree(header, entry));
    m_checksums.push_back(entry.checksum);
  }
  m_checked = std::vector<Flag>(index.size());
  if (check == Check::WhenUsed)
    return;
  m_file.bytes();
  parallel_ranges(index.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      check_tree(i);
  });
}

void TreeSet::check_tree(std::size_t i) const {
  const std::lock_guard lock((*m_mutexes)[i % m_mutexes->size()]);
  if (m_checked[i].set.load(std::memory_order_relaxed))
    return; // another thread was first
  const TreeView& view = m_trees[i];
  const FileRules rules(path());
  const auto* start = reinterpret_cast<const std::byte*>(view.links - (m_levels + 1));
  const auto offset = static_cast<std::uint64_t>(start - m_file.place(0));
  const std::span<const std::byte> bytes = m_file.part(offset, bytes_of(view));
  rules.require(hash_bytes(bytes) == m_checksums[i], offset, "tree checksum does not fit the tree");
  rules.check_links(view, offset);
  rules.check_coefficients(view, offset);
  const std::size_t used =
      4 * (static_cast<std::size_t>(m_levels) + 1 + view.node_count) +
      3 * static_cast<std::size_t>(m_channels) * coefficient_bytes(m_type) * view.node_count;
  for (std::size_t at = used; at < bytes.size(); ++at)
    rules.require(bytes[at] == std::byte{0}, offset + at, "padding after the tree is not 0");
  m_checked[i].set.store(true, std::memory_order_release);
}

std::uint32_t TreeSet::level_nodes(int column, int row, int level) const {
  const std::uint32_t* level_begin = tree(column, row).links - (m_levels + 1);
  return level_begin[level + 1] - level_begin[level];
}

std::uint64_t TreeSet::bytes_of(const TreeView& view) const {
  return tree_size(view.node_count, static_cast<std::uint64_t>(m_levels),
                   static_cast<std::uint64_t>(m_channels), coefficient_bytes(m_type));
}

std::uint64_t TreeSet::tree_bytes(int column, int row) const {
  return bytes_of(m_trees[place(column, row)]);
}

bool begins_as_tree_set(const InputFile& file) {
  const auto bytes = file.beginning(sizeof file_magic);
  return begins_mapped(bytes) || begins_packed(bytes);
}

TreeSetWriter::TreeSetWriter(OutputFile& file, const SetInfo& info, int channels,
                             CoefficientType type)
    : m_file(file), m_layout(std::make_unique<SetLayout>(info, channels, type)) {
  m_file.seek(align_up(sizeof(FileHeader)));
}

TreeSetWriter::~TreeSetWriter() = default;

void TreeSetWriter::add(Tree tree) {
  const std::vector<std::byte> bytes = m_layout->add(tree);
  m_file.write(bytes.data(), bytes.size());
}

void TreeSetWriter::finish() {
  m_layout->finish();
  const auto index = std::as_bytes(std::span(m_layout->index()));
  m_file.write(index.data(), index.size());
  m_file.write(m_layout->text().data(), m_layout->text().size());
  const std::uint64_t end = m_file.position();
  unsigned char padded[128] = {};
  static_assert(sizeof padded == (sizeof(FileHeader) + 15) / 16 * 16);
  std::memcpy(padded, &m_layout->header(), sizeof(FileHeader));
  m_file.seek(0);
  m_file.write(padded, sizeof padded);
  m_file.seek(end);
}

std::span<const std::byte> TreeSetWriter::header() const {
  return std::as_bytes(std::span(&m_layout->header(), 1));
}

} // namespace haarlight::wavelet
