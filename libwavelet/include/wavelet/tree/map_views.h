#pragma once
// Sets of maps seen in another form: what makes two sets comparable. Every view makes a map when it
// is asked for one, and keeps what it looks at alive.

#include <wavelet/file/tree_set.h>
#include <wavelet/square/symmetry.h>
#include <wavelet/tree/map_set.h>

#include <memory>

namespace haarlight::wavelet {

using SharedMaps = std::shared_ptr<const MapSource>;

/// The map that stored pixels stand for: pixel p is the stored one at symmetry.to_stored(p).
Map turned(const Map& stored, const SquareSymmetry& symmetry);

/// The maps of a .haar file, reconstructed at their finest level.
SharedMaps tree_maps(std::shared_ptr<const TreeSet> trees);

/// Averages down to `size` pixels a side. @param size a power of two, at most the set's
SharedMaps shrunk(SharedMaps maps, int size);

/// All rolls of a folded set, one row each, in the order of <wavelet/square/symmetry.h>.
SharedMaps unfolded(SharedMaps maps);

/// One map, as a set of its own. Its info keeps the kind; rolls and fold are those of one map.
SharedMaps one_map(SharedMaps maps, int column, int row);

/// Luminance in all three channels.
SharedMaps in_luminance(SharedMaps maps);

} // namespace haarlight::wavelet
