#pragma once
// Header, index and text of a mapped file, kept up while its trees are made. Both forms of a .haar
// file need them: the packed one carries the mapped one's header.

#include "file/file_layout.h"

#include <wavelet/tree/tree.h>

#include <string>
#include <vector>

namespace haarlight::wavelet {

class SetLayout {
public:
  SetLayout(const SetInfo& info, int channels, CoefficientType type);

  /// Notes the next tree. @return its bytes in the mapped form, padding included
  std::vector<std::byte> add(const Tree& tree);

  /// Fills in what depends on the trees, all of which must have been added.
  void finish();

  const FileHeader& header() const { return m_header; }
  const std::string& text() const { return m_text; }
  const std::vector<IndexEntry>& index() const { return m_index; }

private:
  FileHeader m_header;
  std::string m_text;
  std::vector<IndexEntry> m_index;
  std::uint64_t m_position;
};

} // namespace haarlight::wavelet
