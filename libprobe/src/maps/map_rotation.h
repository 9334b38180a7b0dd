#pragma once
// Maps of rotated frames, made from one map of the world.

#include <probe/probe_maps.h>

namespace haarlight::probe {

/// Side of the world map that a table's maps look up. Each of the frames a cell is averaged over
/// samples the sphere once per map pixel, and the frames lie a √frames-th of the cell apart: pixels
/// of about the larger of the two distances neither miss a light nor blur it more than the cell
/// does.
int matching_level_size(const MapOptions& options, int full_size);

/// A world map averaged down to `size`, its peaks made lights.
/// @param map_size side of the maps to be made: a light is spread over several points where their
///                 pixels are smaller than the level's
WorldLevel make_level(const wavelet::Map& map, int size, int map_size);

/// The map of one cell of ω_r, averaged over the cell.
wavelet::Map rotated_map(const WorldLevel& level, const MapOptions& options, int column, int row);

} // namespace haarlight::probe
