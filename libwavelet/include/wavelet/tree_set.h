#pragma once
// .haar files: sets of trees in one mapped file. The format is specified in FORMAT.md.

#include <wavelet/input_file.h>
#include <wavelet/map_set.h>
#include <wavelet/output_file.h>
#include <wavelet/tree.h>

#include <cstdint>
#include <string>
#include <vector>

namespace haarlight::wavelet {

/// A .haar file, mapped and checked once when opened; its trees are used where they lie.
class TreeSet {
public:
  /// Maps the file and checks all of it: header, index, structure and checksum of every tree.
  /// @throws Error(Input) naming the first broken rule of FORMAT.md and its byte offset
  explicit TreeSet(const std::string& path);

  const std::string& path() const { return m_file.path(); }
  std::uint64_t file_bytes() const { return m_file.bytes().size(); }
  const SetInfo& info() const { return m_info; }
  int levels() const { return m_levels; }
  int channels() const { return m_channels; }
  CoefficientType coefficients() const { return m_type; }

  /// The stored tree of a column and a row; valid while this set lives.
  /// @param column 0 ≤ column < info().columns
  /// @param row    0 ≤ row < info().rows
  const TreeView& tree(int column, int row) const {
    return m_trees[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_info.columns) +
                   static_cast<std::size_t>(column)];
  }

  /// Nodes of a tree at a level, 0 ≤ level < levels().
  std::uint32_t level_nodes(int column, int row, int level) const;

  /// Bytes a tree takes in the file.
  std::uint64_t tree_bytes(int column, int row) const;

private:
  InputFile m_file;
  SetInfo m_info;
  int m_levels = 0;
  int m_channels = 3;
  CoefficientType m_type = CoefficientType::Half;
  std::vector<TreeView> m_trees;
};

/// True if the first bytes are those of a .haar file, which may be damaged all the same.
bool begins_as_tree_set(const InputFile& file);

/// Writes the trees of a set one after the other, column fastest, then finish(). Memory: the index.
class TreeSetWriter {
public:
  /// @param levels   log2 of info.size
  /// @param channels 3 or 1
  TreeSetWriter(OutputFile& file, const SetInfo& info, int channels, CoefficientType type);

  /// Appends the next tree. @throws Error(Output)
  void add(const Tree& tree);

  /// Writes index, text and header; all trees must have been added. @throws Error(Output)
  void finish();

private:
  struct Entry {
    std::uint64_t offset;
    std::uint64_t checksum;
    std::uint32_t node_count;
    float scale;
    float mean[3];
  };
  OutputFile& m_file;
  SetInfo m_info;
  int m_channels;
  CoefficientType m_type;
  std::vector<Entry> m_entries;
};

} // namespace haarlight::wavelet
