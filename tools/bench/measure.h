#pragma once
// The measurement of one BRDF under one probe in one scene.

#include <bench/inputs.h>
#include <bench/plan.h>
#include <bench/results.h>

#include <wavelet/base/image.h>

#include <functional>
#include <string>
#include <vector>

namespace haarlight::bench {

/// A picture of one sampler at equal time, with the smallest budget.
struct Exhibit {
  renderer::SamplerKind sampler = renderer::SamplerKind::Product;
  int spp = 0;
  double relmse = 0;
  Image picture;
};

struct PairResult {
  std::string brdf;
  std::string probe;
  std::string scene;
  std::string light_note; ///< how the probe was read
  std::vector<Row> rows;
  Image reference;
  std::vector<bool> hit; ///< pixels that show an object
  std::vector<Exhibit> exhibits;
};

/// Called with units of finished work, of work_units() in total.
using WorkDone = std::function<void(double units)>;

/// Renders the reference, then every sampler at equal samples and at equal time.
/// @param scene a word as scene_of() takes
/// @throws Error(Input) if a scene lacks what a sampler needs, or no pixel hits an object
PairResult measure_pair(const Plan& plan, const Entry& brdf, const Entry& probe,
                        const std::string& scene, const WorkDone& done);

} // namespace haarlight::bench
