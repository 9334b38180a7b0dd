#pragma once
// The stored trees of one material or light, from a .haar file or made in memory.

#include <wavelet/file/tree_set.h>
#include <wavelet/transform/compress.h>

#include <memory>
#include <string>
#include <vector>

namespace haarlight::renderer {

/// Trees by column and row, whoever owns them. Movable; views stay valid.
class TreeTable {
public:
  /// Maps a file.
  /// @param check when its trees are checked: the thousands of a table are better left until used
  /// @throws Error(Input) if it is broken, or not of the kind wanted
  TreeTable(const std::string& path, wavelet::SetKind kind,
            wavelet::Check check = wavelet::Check::Everything);

  /// Makes and compresses every map of a source, with default options.
  explicit TreeTable(const wavelet::MapSource& source);

  const wavelet::SetInfo& info() const { return m_info; }

  /// All trees, column fastest. @throws as tree()
  std::vector<wavelet::TreeView> trees() const;

  /// @throws Error(Input) if it is of a file, unchecked so far, and broken
  const wavelet::TreeView& tree(int column, int row) const {
    if (m_file)
      return m_file->tree(column, row);
    return m_views[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_info.columns) +
                   static_cast<std::size_t>(column)];
  }

private:
  std::unique_ptr<wavelet::TreeSet> m_file;
  std::vector<wavelet::Tree> m_owned;
  wavelet::SetInfo m_info;
  std::vector<wavelet::TreeView> m_views; ///< of m_owned
};

} // namespace haarlight::renderer
