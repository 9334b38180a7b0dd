#include <support/compare_report.h>

namespace haarlight::tool {
namespace {

using wavelet::Difference;
using wavelet::LevelDifference;
using wavelet::MapPlace;
using wavelet::SetDifference;

void add_norms(const Difference& difference, Report& report) {
  report.add("l2", difference.l2())
      .add("relative_l2", difference.relative_l2())
      .add("linf", difference.largest_error)
      .add("relative_linf", difference.relative_linf())
      .add("psnr", difference.psnr(), "dB");
}

/// Indices are those of A.
Report& add_place(const MapPlace& place, const ComparedSets& sets, Report& report) {
  return report.add("column", sets.first_a.column + place.column)
      .add("row", sets.first_a.row + place.row);
}

void add_places(const SetDifference& result, const ComparedSets& sets, Report& report) {
  add_place(result.largest, sets, report.section("largest_difference"))
      .add("x", result.x)
      .add("y", result.y)
      .add("value", result.difference.largest_error);
  Report& worst = report.section("worst_map");
  add_place(result.worst, sets, worst);
  add_norms(result.worst_difference, worst);
}

template <class Level>
void add_level(const Level& name, const LevelDifference& level, double total, Report& report) {
  report.row("levels")
      .add("level", name)
      .add("l2", level.l2())
      .add("relative_l2", level.relative_l2())
      .add("share", share(level.difference, total));
}

void add_levels(const Difference& difference, Report& report) {
  add_level("mean", difference.mean, difference.squared_error, report);
  for (std::size_t l = 0; l < difference.levels.size(); ++l)
    add_level(l, difference.levels[l], difference.squared_error, report);
}

} // namespace

Report describe(const SetDifference& result, const CompareInput& input, const ComparedSets& sets) {
  const wavelet::SetInfo& info = sets.a->info();
  Report report;
  report.add("reference", input.reference)
      .add("compared", input.compared)
      .add("values", sets.values)
      .add("units", info.units)
      .add("map_size", info.size, "px")
      .add("columns", info.columns)
      .add("rows", info.rows)
      .add("maps", result.maps);
  add_norms(result.difference, report);
  Report& integrals = report.section("integrals");
  integrals.add("mean_error", result.mean_error).add("worst_error", result.worst_mean_error);
  add_place(result.worst_mean, sets, integrals);
  add_places(result, sets, report);
  add_levels(result.difference, report);
  return report;
}

} // namespace haarlight::tool
