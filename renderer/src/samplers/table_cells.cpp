#include "samplers/table_cells.h"

#include <probe/probe_maps.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

int cell_of(float coordinate, int cells) {
  return std::clamp(static_cast<int>(coordinate * static_cast<float>(cells)), 0, cells - 1);
}

} // namespace

Frame entry_frame(const TreeTable& table, const TableCells& cells) {
  return probe::light_frame(cells.light_column, cells.light_row, table.info().columns);
}

TableCells nearest_cells(const TreeTable& table, const ShadingPoint& point,
                         const Material& material) {
  const Vec2 p = wavelet::sphere_to_square(point.reflection.frame.n);
  TableCells cells;
  cells.light_column = cell_of(p.x(), table.info().columns);
  cells.light_row = cell_of(p.y(), table.info().columns);
  const wavelet::SetInfo& rolls = material.roll_table()->info();
  const Vec3 n = entry_frame(table, cells).to_local(point.n);
  const float theta_r = arctangent(std::sqrt(n.x() * n.x() + n.y() * n.y()), n.z());
  const float phi = arctangent(n.y(), n.x());
  cells.theta = cell_of(theta_r * (2.0F / pi), rolls.columns);
  cells.roll = cell_of(phi / (2.0F * pi) + (phi < 0 ? 1.0F : 0.0F), rolls.rolls);
  return cells;
}

RollEntry roll_entry(const TreeTable& rolls, const TableCells& cells) {
  const wavelet::StoredRoll stored = wavelet::stored_roll(rolls.info(), cells.roll);
  return {rolls.tree(cells.theta, stored.row), stored.symmetry};
}

} // namespace haarlight::renderer
