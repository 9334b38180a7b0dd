#include <support/map_report.h>

namespace haarlight::tool {

using wavelet::CompressOptions;
using wavelet::CompressReport;
using wavelet::Conservation;

void describe_set(const wavelet::SetInfo& info, Report& report) {
  report.add("map_size", info.size, "px")
      .add("columns", info.columns)
      .add("rows", info.rows)
      .add("maps", info.map_count());
}

void describe(const Conservation& conservation, double tolerance, Report& report) {
  report.section("conservation")
      .add("mean_error", conservation.mean_error)
      .add("worst_error", conservation.largest_error)
      .add("worst_column", conservation.worst_column)
      .add("worst_row", conservation.worst_row)
      .add("tolerance", tolerance);
}

void describe(const CompressReport& result, const CompressOptions& options, Report& report) {
  const auto total = static_cast<double>(result.total_coefficients);
  const auto kept = static_cast<double>(result.kept_coefficients);
  Report& part = report.section("compression");
  part.add("criterion", wavelet::criterion_name(options.threshold.criterion));
  if (options.threshold.keep)
    part.add("keep", *options.threshold.keep);
  else
    part.add("tolerance", options.threshold.tolerance);
  if (options.quantize)
    part.add("quantize", true);
  part.add("coefficients", result.total_coefficients)
      .add("kept_coefficients", result.kept_coefficients)
      .add("kept_share", share(kept, total))
      .add("nodes", result.nodes)
      .add("relative_l2_error", result.relative_l2_error())
      .add("relative_linf_error", result.relative_linf_error())
      .add("negative_mass_share", share(result.negative_mass, result.mass));
}

} // namespace haarlight::tool
