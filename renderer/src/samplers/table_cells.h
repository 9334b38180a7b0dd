#pragma once
// The nearest entries of the paper's two tables at a shading point.

#include <renderer/light/light.h>
#include <renderer/material/material.h>

#include <wavelet/square/symmetry.h>

namespace haarlight::renderer {

/// The light's cell of ω_r, and the reflectance's cells of θ_r and roll in that cell's frame.
/// Points with the same cells have the same product.
struct TableCells {
  int light_column = 0;
  int light_row = 0;
  int theta = 0; ///< column of the reflectance's table
  int roll = 0;  ///< over the full circle, stored or not

  bool operator==(const TableCells&) const = default;
};

/// @param table of the light's maps; the material must have a roll table
TableCells nearest_cells(const TreeTable& table, const ShadingPoint& point,
                         const Material& material);

/// The frame of a light's entry.
Frame entry_frame(const TreeTable& table, const TableCells& cells);

/// The stored tree of a reflectance's entry, and the symmetry that maps it to the entry.
struct RollEntry {
  const wavelet::TreeView& tree;
  wavelet::SquareSymmetry symmetry;
};
RollEntry roll_entry(const TreeTable& rolls, const TableCells& cells);

} // namespace haarlight::renderer
