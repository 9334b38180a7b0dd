#pragma once
// haarbench's report: the best samplers, and one HTML page.

#include <bench/measure.h>
#include <bench/plan.h>
#include <bench/results.h>

#include <html/plot.h>

#include <support/report.h>

#include <string>
#include <vector>

namespace haarlight::bench {

/// The samplers that were compared at one number of samples or one budget.
struct Verdict {
  const Row* winner = nullptr;       ///< with the smallest relmse
  double product_over_mis = unknown; ///< relmse of mis / relmse of product, if both took part
  std::vector<const Row*> rows;      ///< of all that took part
};

/// One for each pair, scene, kind of points, mode and spp or budget, in the order of the rows.
/// @param rows must outlive the result
std::vector<Verdict> verdicts_of(const std::vector<Row>& rows);

/// haarbench's output: lists "equal_samples" and "equal_time" of verdicts; product_over_mis only
/// where both took part.
tool::Report describe(const std::vector<Verdict>& verdicts);

/// The whole page.
std::string page_html(const Plan& plan, const std::vector<PairResult>& pairs,
                      const std::vector<Verdict>& verdicts);

/// The section about one pair: convergence plots, a table of figures, and pictures with their
/// errors.
std::string pair_html(const Plan& plan, const PairResult& pair);

/// The style of a sampler, the same in every figure; dashed if the sampler is biased.
html::PlotStyle style_of(renderer::SamplerKind kind);

/// A sampler's name with its line and marker, tagged if it is biased.
std::string sampler_html(const std::string& name);

// Pictures as data URIs of PNG files. They show the centre of the film, at most 128 × 128 pixels.

/// Tone-mapped with an exposure that fits the reference.
std::string picture_uri(const PairResult& pair, const Image& picture);

/// The relative error of luminance, (x − r)/sqrt(r² + ε), in false colours of the square root of
/// its magnitude: black 0, yellow + 100 % or more, cyan − 100 % or less; white where no object is.
std::string error_uri(const PairResult& pair, const Image& picture);

/// The colours of error_uri() from − 100 % to + 100 %, linear in the square root of the error.
std::string legend_uri();

} // namespace haarlight::bench
