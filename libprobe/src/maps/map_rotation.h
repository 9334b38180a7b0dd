#pragma once
// Maps of rotated frames, made from one map of the world.

#include <probe/probe_maps.h>

namespace haarlight::probe {

/// Side of the world map that a table's maps look up. Each of the frames a cell is averaged over
/// samples the sphere once per map pixel, and the frames lie a √frames-th of the cell apart: pixels
/// of half the larger of the two distances are neither missed nor blurred much more than the cell
/// blurs them (grace at 128², 64 × 64 cells, 16 frames: 8 % of the norm off; 20 % with pixels of
/// the whole distance).
int matching_level_size(const MapOptions& options, int full_size);

/// A world map averaged down to `size`, its peaks apart from the rest.
WorldLevel make_level(const wavelet::Map& map, int size);

/// The map of one cell of ω_r, averaged over the cell.
wavelet::Map rotated_map(const WorldLevel& level, const MapOptions& options, int column, int row);

} // namespace haarlight::probe
