#pragma once
// haarinfo's page about a .haar file.

#include <support/compare.h>
#include <support/inspect.h>

#include <wavelet/file/tree_set.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::info {

struct PageInput {
  std::string path;
  wavelet::FileForm form = wavelet::FileForm::Mapped;
  std::vector<double> tree; ///< column and row if only one tree is looked at
  std::optional<int> level; ///< of pictures and masses; the finest that serves if unset
  std::string reference;    ///< the maps that the trees were made of, if not empty
};

/// A whole page, the same for any number of threads.
/// @param trees   those looked at: all, or one
/// @param figures of these trees
/// @throws Error(Input) for a reference that cannot be read or compared
std::string page_html(const wavelet::TreeSet& set, const PageInput& input,
                      const std::vector<wavelet::MapPlace>& trees,
                      const std::vector<tool::TreeFigures>& figures);

} // namespace haarlight::info
