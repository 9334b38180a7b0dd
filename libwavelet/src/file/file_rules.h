#pragma once
// The rules of FORMAT.md that header, index and trees must keep, wherever they come from.

#include "file/file_layout.h"

#include <wavelet/tree/tree.h>

#include <cstdint>
#include <span>
#include <string>

namespace haarlight::wavelet {

/// Refuses a file at the first rule that does not hold.
class FileRules {
public:
  /// @param path of the file, as errors shall name it
  explicit FileRules(std::string path) : m_path(std::move(path)) {}

  /// @throws Error(Input) with the message unless the rule holds
  void require(bool holds, std::uint64_t offset, const char* message) const {
    if (!holds)
      refuse(offset, message);
  }
  [[noreturn]] void refuse(std::uint64_t offset, const std::string& message) const;

  /// Everything but the offsets and sizes of sections. @param offset of the header in the file
  void check_header(const FileHeader& header, std::uint64_t offset) const;
  void check_entry(const IndexEntry& entry, std::uint64_t offset) const;
  /// Children follow each other without gaps, level by level, and end where the level table says.
  /// @param offset of the tree in the file, whose level table lies before the view's links
  void check_links(const TreeView& tree, std::uint64_t offset) const;
  void check_coefficients(const TreeView& tree, std::uint64_t offset) const;

private:
  void check_rolls(const FileHeader& header, std::uint64_t offset) const;

  std::string m_path;
};

} // namespace haarlight::wavelet
