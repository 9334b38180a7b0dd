#include <support/compare_bounds.h>

#include <support/words.h>

#include <array>

namespace haarlight::tool {
namespace {

constexpr double most = 1e300;

struct Bound {
  const char* option;
  std::optional<double> bound;
  double value;
  bool least = false; ///< the bound is one from below
};

/// Not-a-number holds no bound.
bool holds(const Bound& bound) {
  return bound.least ? bound.value >= *bound.bound : bound.value <= *bound.bound;
}

std::string complaint(const Bound& bound) {
  const double by = bound.least ? *bound.bound - bound.value : bound.value - *bound.bound;
  return std::string(bound.option) + " " + short_text(*bound.bound) +
         " is broken: " + short_text(bound.value) +
         (bound.least ? " is too small by " : " is too large by ") + short_text(by);
}

} // namespace

void add_compare_bounds(Tool& tool, CompareBounds& bounds) {
  tool.value(
      bounds.l2, "--max-l2",
      "Largest root mean square difference, in the maps' unit, colours weighted by luminance; "
      "past any bound the exit code is 1",
      0, most);
  tool.value(bounds.relative_l2, "--max-relative-l2", "The same relative to the norm of A", 0,
             most);
  tool.value(bounds.linf, "--max-linf", "Largest difference of any pixel and channel", 0, most);
  tool.value(bounds.psnr, "--min-psnr", "Least peak signal-to-noise ratio, dB", -1000, 1000);
  tool.value(
      bounds.mean_error, "--max-mean-error",
      "Largest relative error of any map's average (of the albedo, for maps with the cosine)", 0,
      most);
}

std::string judge(const wavelet::SetDifference& result, const CompareBounds& bounds,
                  Report& report) {
  const wavelet::Difference& d = result.difference;
  const std::array<Bound, 5> all = {
      {{"--max-l2", bounds.l2, d.l2()},
       {"--max-relative-l2", bounds.relative_l2, d.relative_l2()},
       {"--max-linf", bounds.linf, d.largest_error},
       {"--min-psnr", bounds.psnr, d.psnr(), true},
       {"--max-mean-error", bounds.mean_error, result.worst_mean_error}}};
  std::string broken;
  for (const Bound& bound : all) {
    if (!bound.bound)
      continue;
    report.row("bounds")
        .add("option", bound.option)
        .add("bound", *bound.bound)
        .add("value", bound.value)
        .add("holds", holds(bound));
    if (!holds(bound))
      broken.append(broken.empty() ? "" : "; ").append(complaint(bound));
  }
  return broken;
}

} // namespace haarlight::tool
