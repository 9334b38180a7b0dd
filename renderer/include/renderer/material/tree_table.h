#pragma once
// The trees of one material or light, from a .haar file or built in memory.

#include <wavelet/file/tree_set.h>
#include <wavelet/transform/compress.h>

#include <memory>
#include <string>
#include <vector>

namespace haarlight::renderer {

/// Trees by column and row. Movable; views stay valid.
class TreeTable {
public:
  /// Memory-maps a file.
  /// @param check when trees are validated; for tables of thousands of trees, better on first use
  /// @throws Error(Input) if it is malformed or of another kind
  TreeTable(const std::string& path, wavelet::SetKind kind,
            wavelet::Check check = wavelet::Check::Everything);

  /// Computes and compresses every map of a source, with default options.
  explicit TreeTable(const wavelet::MapSource& source);

  const wavelet::SetInfo& info() const { return m_info; }

  /// All trees, column fastest. @throws as tree()
  std::vector<wavelet::TreeView> trees() const;

  /// @throws Error(Input) on first use of a malformed tree of a file
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
