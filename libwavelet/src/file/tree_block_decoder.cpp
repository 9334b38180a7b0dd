#include "file/tree_block.h"
#include "file/zstd_frame.h"
#include "tree/tree_writer.h"

#include <wavelet/file/input_file.h>

#include <array>
#include <cstring>

namespace haarlight::wavelet {
namespace {

using Bytes = std::vector<std::byte>;

/// Reads one block stream by stream; each stream's size follows from what was read before.
class BlockDecoder {
public:
  BlockDecoder(std::span<const std::byte> block, const FileHeader& set, const FileRules& rules,
               std::uint64_t offset)
      : m_block(block), m_set(set), m_rules(rules), m_offset(offset),
        m_type(static_cast<CoefficientType>(set.coefficient_type)),
        m_width(coefficient_bytes(m_type)) {}

  BlockSizes scan() {
    read_header();
    read_records();
    require_size(1, m_records.size() * m_set.levels);
    require_size(2, m_sizes.nodes);
    m_sizes.values = frame_content_size(m_frames[3]).value_or(0);
    require(m_sizes.values <= 3 * m_sizes.nodes,
            "frame does not hold as many bytes as the trees of its block need");
    for (std::size_t k = 3; k < m_frames.size(); ++k)
      require_size(k, m_sizes.values);
    return m_sizes;
  }

  DecodedBlock decode() {
    scan();
    const Bytes forms = stream(1, m_records.size() * m_set.levels);
    m_structure = stream(2, m_sizes.nodes);
    require(std::none_of(m_structure.begin(), m_structure.end(),
                         [](std::byte b) { return (b & std::byte{128}) != std::byte{0}; }),
            "structure byte has bit 7 set");
    const auto empty = count_empty_nodes(m_structure);
    require(empty.has_value(), "child masks do not add up to the number of nodes");
    require(*empty <= largest_empty_nodes, empty_nodes_message);
    start_trees();
    read_structure();
    read_planes();
    read_values(forms);
    for (const Tree& tree : m_trees)
      m_rules.check_coefficients(tree.view(), m_offset);
    return {std::move(m_trees), *empty};
  }

private:
  void require(bool holds, const char* message) const { m_rules.require(holds, m_offset, message); }

  void read_header() {
    const std::size_t count = stream_count(static_cast<int>(m_set.channels), m_type);
    const std::size_t start = sizeof(BlockHeader) + 4 * count;
    require(m_block.size() >= start, "block is shorter than its header");
    std::memcpy(&m_header, m_block.data(), sizeof m_header);
    require(hash_bytes(m_block.subspan(sizeof m_header)) == m_header.checksum,
            "block checksum does not fit the block");
    std::vector<std::uint32_t> sizes(count);
    std::memcpy(sizes.data(), m_block.data() + sizeof m_header, 4 * count);
    std::size_t next = start;
    for (const std::uint32_t size : sizes) {
      require(size <= m_block.size() - next, "frame reaches beyond its block");
      m_frames.push_back(m_block.subspan(next, size));
      next += size;
    }
    require(next == m_block.size(), "block does not end with its last frame");
  }

  void require_size(std::size_t frame, std::uint64_t size) const {
    require(frame_content_size(m_frames[frame]) == size,
            "frame does not hold as many bytes as the trees of its block need");
  }

  Bytes stream(std::size_t index, std::uint64_t size) const {
    require_size(index, size);
    Bytes content(size);
    require(read_frame(m_frames[index], content), "frame is damaged");
    return content;
  }

  void read_records() {
    const std::size_t count = m_header.trees;
    const Bytes planes = stream(0, count * sizeof(TreeRecord));
    m_records.resize(count);
    auto* bytes = reinterpret_cast<std::byte*>(m_records.data());
    for (std::size_t i = 0; i < planes.size(); ++i)
      bytes[i % count * sizeof(TreeRecord) + i / count] = planes[i];
    for (const TreeRecord& r : m_records) {
      m_rules.check_entry({0, 0, r.node_count, r.scale, {r.mean[0], r.mean[1], r.mean[2]}, 0},
                          m_offset);
      require(r.node_count <= ((std::uint64_t{1} << (2 * m_set.levels)) - 1) / 3,
              "tree has more nodes than there are squares");
      m_sizes.nodes += r.node_count;
      m_sizes.mapped_bytes += tree_size(r.node_count, m_set.levels, m_set.channels, m_width);
    }
    require(count == 1 || m_sizes.mapped_bytes <= largest_block_bytes,
            "block holds more than 64 MiB of trees");
    require(m_sizes.mapped_bytes <= m_set.index_offset,
            "block holds more bytes of trees than the mapped file");
  }

  void start_trees() {
    m_trees.resize(m_records.size());
    for (std::size_t i = 0; i < m_trees.size(); ++i)
      start_tree(m_records[i], m_trees[i]);
  }

  void start_tree(const TreeRecord& record, Tree& tree) const {
    tree.levels = static_cast<int>(m_set.levels);
    tree.channels = static_cast<int>(m_set.channels);
    tree.type = m_type;
    tree.scale = record.scale;
    tree.mean = {record.mean[0], record.mean[1], record.mean[2]};
    tree.links.reserve(record.node_count);
    tree.coefficients.resize(3 * m_set.channels * m_width * record.node_count + 8);
  }

  /// Links from child masks, which lie level by level and within a level tree by tree.
  void read_structure() {
    std::vector<LinkWriter> links(m_trees.begin(), m_trees.end());
    std::size_t next = 0;
    for (std::uint32_t level = 0; level < m_set.levels; ++level)
      for (std::size_t i = 0; i < m_trees.size(); ++i)
        next = read_level(i, links[i], next, level + 1 == m_set.levels);
    for (std::size_t i = 0; i < m_trees.size(); ++i) {
      require(m_trees[i].links.size() == m_records[i].node_count,
              "child masks do not add up to the number of nodes");
      links[i].finish();
    }
  }

  /// @param next place in the structure. @return the place after the level
  std::size_t read_level(std::size_t index, LinkWriter& links, std::size_t next, bool last) {
    const std::uint32_t node_count = m_records[index].node_count;
    const std::uint32_t end = std::min(links.level_end(), node_count);
    for (std::size_t node = m_trees[index].links.size(); node < end; ++node, ++next) {
      const auto byte = std::to_integer<std::uint32_t>(m_structure[next]);
      require(!last || (byte & 15U) == 0, "node of the last level has children");
      links.add(byte & 15U);
      require(links.named_nodes() <= node_count,
              "child masks do not add up to the number of nodes");
      m_present += detail::bits_of_nibble(byte >> 4U);
    }
    return next;
  }

  void read_planes() {
    require(m_present == m_sizes.values,
            "frame does not hold as many bytes as the trees of its block need");
    for (std::size_t k = 3; k < m_frames.size(); ++k)
      m_planes.push_back(stream(k, m_sizes.values));
  }

  void read_values(const Bytes& forms) {
    std::size_t node_place = 0;
    std::size_t value = 0;
    for (std::size_t place = 0; place < forms.size(); ++place) {
      Tree& tree = m_trees[place % m_trees.size()];
      const std::size_t level = place / m_trees.size();
      const auto form = LevelForm::parse(std::to_integer<std::uint8_t>(forms[place]));
      require(form && (m_width == 2 || !form->integers), "form of a level is unknown");
      for (std::uint32_t n = tree.level_begin[level]; n < tree.level_begin[level + 1]; ++n) {
        const auto present = std::to_integer<std::uint32_t>(m_structure[node_place++]) >> 4U;
        for (unsigned m = 0; m < 3; ++m)
          if (((present >> m) & 1U) != 0)
            read_coefficient(tree, 3 * static_cast<std::size_t>(n) + m, value++, *form);
      }
    }
  }

  void read_coefficient(Tree& tree, std::size_t triple, std::size_t value, const LevelForm& form) {
    std::byte* to = tree.coefficients.data() + triple * m_set.channels * m_width;
    if (m_width == 2)
      read_halves(to, value, form);
    else
      read_floats(to, value);
    require(std::any_of(to, to + m_set.channels * m_width,
                        [](std::byte b) { return b != std::byte{0}; }),
            "coefficient that is marked as present is 0");
  }

  template <class U>
  U code(std::size_t channel, std::size_t value) const {
    U result = 0;
    for (std::size_t k = 0; k < sizeof(U); ++k)
      result = static_cast<U>(result | std::to_integer<U>(m_planes[channel * sizeof(U) + k][value])
                                           << (8 * k));
    return result;
  }

  void read_halves(std::byte* to, std::size_t value, const LevelForm& form) const {
    const auto first = code<std::uint16_t>(0, value);
    const int base =
        form.integers ? static_cast<std::int16_t>(unzigzag(first)) : std::rotr(first, 1);
    std::array<int, 3> values = {base, base, base};
    if (m_set.channels == 3)
      for (const std::size_t c : {0U, 2U})
        values[c] += form.step * static_cast<std::int16_t>(
                                     unzigzag(code<std::uint16_t>(c == 0 ? 1 : 2, value)));
    for (std::size_t c = 0; c < m_set.channels; ++c) {
      const std::uint16_t half =
          form.integers ? half_of(values[c], form.exponent) : static_cast<std::uint16_t>(values[c]);
      std::memcpy(to + 2 * c, &half, 2);
    }
  }

  std::uint16_t half_of(int integer, int exponent) const {
    const float number = std::ldexp(static_cast<float>(integer), exponent);
    require(std::abs(number) <= 65504, "integer coefficient exceeds a half");
    const std::uint16_t half = float_to_half(number);
    require(half_to_float(half) == number, "integer coefficient is no half");
    return half;
  }

  void read_floats(std::byte* to, std::size_t value) const {
    const std::uint32_t base = std::rotr(code<std::uint32_t>(0, value), 1);
    std::array<std::uint32_t, 3> bits = {base, base, base};
    if (m_set.channels == 3) {
      bits[0] += unzigzag(code<std::uint32_t>(1, value));
      bits[2] += unzigzag(code<std::uint32_t>(2, value));
    }
    std::memcpy(to, bits.data(), 4 * m_set.channels);
  }

  std::span<const std::byte> m_block;
  const FileHeader& m_set;
  const FileRules& m_rules;
  std::uint64_t m_offset;
  CoefficientType m_type;
  std::size_t m_width;
  BlockHeader m_header = {};
  std::vector<std::span<const std::byte>> m_frames;
  std::vector<TreeRecord> m_records;
  BlockSizes m_sizes;
  std::vector<Tree> m_trees;
  Bytes m_structure;
  std::vector<Bytes> m_planes;
  std::uint64_t m_present = 0; ///< coefficients present, by the structure
};

} // namespace

/// In the order of a block the children of all nodes follow each other, so that one pass from the
/// last node to the first suffices. The mark of a node says that it is not empty.
std::optional<std::uint64_t> count_empty_nodes(std::span<std::byte> structure) {
  constexpr std::byte mark{128};
  std::uint64_t empty = 0;
  std::size_t children_end = structure.size();
  for (std::size_t node = structure.size(); node-- > 0;) {
    const auto byte = std::to_integer<std::uint32_t>(structure[node]);
    bool used = byte >> 4U != 0;
    for (std::uint32_t n = detail::bits_of_nibble(byte & 15U); n > 0; --n) {
      if (children_end <= node + 1)
        return std::nullopt;
      --children_end;
      used = used || (structure[children_end] & mark) != std::byte{0};
      structure[children_end] &= ~mark;
    }
    if (used)
      structure[node] |= mark;
    else
      ++empty;
  }
  for (std::byte& root : structure.first(children_end))
    root &= ~mark;
  return empty;
}

BlockSizes scan_block(std::span<const std::byte> block, const FileHeader& set,
                      const FileRules& rules, std::uint64_t offset) {
  return BlockDecoder(block, set, rules, offset).scan();
}

DecodedBlock decode_block(std::span<const std::byte> block, const FileHeader& set,
                          const FileRules& rules, std::uint64_t offset) {
  return BlockDecoder(block, set, rules, offset).decode();
}

} // namespace haarlight::wavelet
