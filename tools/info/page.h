#pragma once
// haarinfo's page about a .haar file, and its sections as HTML.

#include <support/compare.h>
#include <support/inspect.h>

#include <wavelet/file/tree_set.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::info {

struct PageInput {
  std::string path;
  wavelet::FileForm form = wavelet::FileForm::Mapped;
  std::vector<double> tree; ///< column and row if the page is about a single tree
  std::optional<int> level; ///< of pictures; default: the finest of up to 1024 pixels a side
  std::string reference;    ///< the maps that the trees were made from, or empty
};

/// The whole page, the same for any number of threads.
/// @param trees   all trees of the set, or one
/// @param figures of these trees
/// @throws Error(Input) for a reference that cannot be read or compared
std::string page_html(const wavelet::TreeSet& set, const PageInput& input,
                      const std::vector<wavelet::MapPlace>& trees,
                      const std::vector<tool::TreeFigures>& figures);

/// The error of the set against the reference, and the maps with the largest error: original,
/// reconstruction and difference.
/// @param input the reference, the .haar file and, for a single map, its column and row
/// @throws as tool::open_compared()
std::string worst_maps_html(const tool::CompareInput& input);

/// Slices and a polar plot of lobes; empty unless the set is of BRDF kind.
std::string lobes_html(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees);

struct KeptPoint {
  std::uint64_t kept = 0; ///< coefficients (RGB triples), the largest of all trees together
  double error = 0;       ///< L2 norm of the other coefficients, relative to that of all trees
};

/// The error that trees would have if fewer coefficients were kept. The averages of the trees are
/// always kept and do not count. Coefficients are ranked by energy, L2-normalised and weighted by
/// luminance, so that by Parseval's identity the energy of the rest is the squared error. Uses
/// several threads; the result does not depend on their number.
/// @return by increasing `kept`, about twenty points a decade, from one coefficient to all that are
///         not zero; empty if all are zero
std::vector<KeptPoint> error_curve(const wavelet::TreeSet& set,
                                   const std::vector<wavelet::MapPlace>& trees);

} // namespace haarlight::info
