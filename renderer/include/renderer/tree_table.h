#pragma once
// The stored trees of one material or light, from a .haar file or made in memory.

#include <wavelet/compress.h>
#include <wavelet/tree_set.h>

#include <memory>
#include <string>
#include <vector>

namespace haarlight::renderer {

/// Trees by column and row, whoever owns them. Movable; views stay valid.
class TreeTable {
public:
  /// Maps a file. @throws Error(Input) if it is broken, or not of the kind wanted
  TreeTable(const std::string& path, wavelet::SetKind kind);

  /// Makes and compresses every map of a source, with default options.
  explicit TreeTable(const wavelet::MapSource& source);

  const wavelet::SetInfo& info() const { return m_info; }
  const std::vector<wavelet::TreeView>& trees() const { return m_views; }
  const wavelet::TreeView& tree(int column, int row) const {
    return m_views[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_info.columns) +
                   static_cast<std::size_t>(column)];
  }

private:
  std::unique_ptr<wavelet::TreeSet> m_file;
  std::vector<wavelet::Tree> m_owned;
  wavelet::SetInfo m_info;
  std::vector<wavelet::TreeView> m_views;
};

} // namespace haarlight::renderer
