#include <renderer/transfer/transfer.h>

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace haarlight::renderer {
namespace {

constexpr std::size_t batch_pixels = 4096;

/// A tree, and what making it left.
struct Made {
  wavelet::Tree tree;
  wavelet::ProjectionReport report;
};

void account(const Made& made, const std::string& scene_path, TransferReport& sums) {
  if (made.report.squares == 0)
    return;
  if (!std::isfinite(made.report.dropped + made.report.unresolved))
    throw_input_error(scene_path,
                      "light and reflectances are too large for a transfer: the squares "
                      "of their products exceed the largest single-precision number; "
                      "the light must be scaled down");
  ++sums.pixels;
  sums.nodes += made.tree.links.size();
  sums.mean_squares += static_cast<double>(made.report.squares);
  sums.error += made.report.dropped;
  sums.unresolved += made.report.unresolved;
}

TransferReport averaged(TransferReport sums) {
  const double pixels = std::max(static_cast<double>(sums.pixels), 1.0);
  sums.mean_squares /= pixels;
  sums.error = std::sqrt(sums.error / pixels);
  sums.unresolved = std::sqrt(sums.unresolved / pixels);
  return sums;
}

/// In six digits and the C locale.
std::string number_text(double number) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << number;
  return text.str();
}

std::string units_of(Varying varying) {
  switch (varying) {
  case Varying::Light:
    return "f_r cos v, 1/sr";
  case Varying::Object:
    return "f_r cos L v, radiance per sr";
  default:
    return "L v, radiance";
  }
}

} // namespace

double default_transfer_tolerance(Varying varying) {
  switch (varying) {
  case Varying::Light:
    return 0.15;
  case Varying::Object:
    return 0.8;
  default:
    return 0.5;
  }
}

wavelet::SetInfo transfer_info(const SceneDescription& scene, const Variation& variation,
                               const wavelet::ProjectionOptions& options, int width, int height) {
  wavelet::SetInfo info;
  info.size = 1 << options.levels;
  info.columns = width;
  info.rows = height;
  info.frame = "the light's: the world (right +x, up +y, forward -z) turned by the scene's rotate";
  info.units = units_of(variation.varying);
  Provenance& p = info.provenance;
  p.set("transfer", "1");
  p.set("scene", base_name(scene.path));
  p.set("scene_hash", scene.hash);
  p.set("vary", variation_text(scene, variation));
  p.set("resolution", std::to_string(info.size));
  p.set("tolerance", number_text(options.tolerance));
  p.set("version", version_text());
  return info;
}

TransferReport build_transfer(const LoadedScene& scene, const Variation& variation,
                              const wavelet::ProjectionOptions& options, int width, int height,
                              wavelet::TreeSink& sink, const wavelet::Progress& progress) {
  const int moved = variation.varying == Varying::Object ? variation.index : -1;
  const std::vector<FilmPoint> points = film_points(scene.description(), width, height, moved);
  const VisibilityTrees visibility(scene.shapes(), scene.light());
  const std::vector<float> variances = wavelet::variances_within(scene.light().tree());
  TransferReport report;
  std::vector<Made> batch;
  for (std::size_t first = 0; first < points.size(); first += batch_pixels) {
    batch.clear();
    batch.resize(std::min(batch_pixels, points.size() - first));
    parallel_ranges(batch.size(), 64, [&](std::size_t begin, std::size_t end) {
      TransferMaker maker(scene, visibility, variation, options, variances);
      for (std::size_t i = begin; i < end; ++i)
        batch[i] = {maker.make(points[first + i]), maker.report()};
    });
    for (Made& made : batch) {
      account(made, scene.description().path, report);
      sink.add(std::move(made.tree));
    }
    if (progress)
      progress(static_cast<int>(first + batch.size()), static_cast<int>(points.size()));
  }
  return averaged(report);
}

} // namespace haarlight::renderer
