#pragma once
// Statistics, pictures and coefficients of a .haar file, for haarinfo.

#include <support/report.h>

#include <wavelet/base/image.h>

#include <wavelet/file/tree_set.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace haarlight::tool {

struct LevelFigures {
  std::uint64_t nodes = 0;   ///< squares with wavelets
  std::uint64_t nonzero = 0; ///< coefficients (RGB triples) that are not zero
  double energy = 0; ///< sum of squares of L2-normalised coefficients, weighted by luminance
};

struct TreeFigures {
  wavelet::MapPlace index;
  std::uint64_t nodes = 0;
  std::uint64_t bytes = 0; ///< in the file
  Rgb mean = Rgb::Zero();
  std::vector<LevelFigures> levels;
  double energy = 0;        ///< ∫∫ F² over the unit square, colours weighted by luminance
  double mass = 0;          ///< ∫∫ |F|, luminance
  double negative_mass = 0; ///< ∫∫ max(0, −F), luminance
};

/// All trees of a set, column fastest.
std::vector<wavelet::MapPlace> all_trees(const wavelet::TreeSet& set);

/// Figures of some trees; masses are those of the reconstruction at `level`. From several threads.
std::vector<TreeFigures> measure_trees(const wavelet::TreeSet& set,
                                       const std::vector<wavelet::MapPlace>& trees, int level);

/// Their sum. @param levels of their set
TreeFigures sum_of(const std::vector<TreeFigures>& figures, int levels);

/// `mapped` or `packed`.
const char* form_name(wavelet::FileForm form);

/// Header and provenance of a set. @param form of the file that it was opened from
Report describe_header(const wavelet::TreeSet& set, wavelet::FileForm form);
/// Adds counts per level, sparsity, energy, negative mass and sizes, summed over `figures`, and, if
/// asked for, a line for each tree.
void describe_figures(const std::vector<TreeFigures>& figures, int levels, bool list_trees,
                      Report& report);

/// A tree reconstructed at a level: linear, possibly negative.
Image tree_picture(const wavelet::TreeView& tree, int level);

/// The finest level at which atlas() stays within `largest_side` pixels a side.
int atlas_level(const wavelet::TreeSet& set, std::int64_t largest_side = 2048);
/// All trees at a level: the table of the set, or, if it has one row, the row folded to a square.
Image atlas(const wavelet::TreeSet& set, int level);
/// Pixels along the atlas' longer side.
std::int64_t atlas_side(const wavelet::TreeSet& set, int level);

/// Lines `column,row,level,x,y,type,r,g,b`: the differences of every node, a few at a time.
void dump_csv(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees,
              const std::function<void(const std::string&)>& sink);

} // namespace haarlight::tool
