#include <render/render_options.h>

#include <string>
#include <utility>
#include <vector>

namespace haarlight::tool {

using namespace renderer;

void declare_sampling(Tool& app, RenderOptions& render) {
  std::vector<std::pair<std::string, SamplerKind>> kinds;
  for (const SamplerTraits& sampler : samplers())
    kinds.emplace_back(sampler.name, sampler.kind);
  app.choice(render.sampler, "--sampler", kinds,
             "Where light directions are drawn from; renderer/SAMPLERS.md tells of each");
  app.choice(render.estimator, "--estimator",
             {{"unbiased", Estimator::Unbiased},
              {"bidirectional", Estimator::Bidirectional},
              {"ratio", Estimator::Ratio}},
             "How samples become radiance");
  app.choice(render.points, "--points", {{"random", Points::Random}, {"sobol", Points::Sobol}},
             "Random numbers, or Owen-scrambled Sobol points");
  app.value(render.spp, "--spp", "Light samples per pixel; with --time-limit of the first pass", 1,
            1 << 20);
  app.value(render.time_limit, "--time-limit",
            "Seconds to go on in passes for; the result then depends on the machine; 0 = one pass",
            0, 1e6);
  app.value(render.sampling.product.variance_bound, "--product-variance",
            "Relative variance per sample at which products stop refining; 0 = 0.12 / sqrt(spp) "
            "within 0.002 to 0.1, thrice that where there may be shadows (product-visibility: six "
            "times), and 0.001 for bidirectional and ratio",
            0, 100);
  app.value(
      render.sampling.product.max_leaves, "--product-leaves",
      "Leaves of a product at most; product-visibility takes 25 for each sample at most, or 400 "
      "where there may be shadows",
      64, 1 << 20);
  app.value(render.sampling.product.reuse_variance_bound, "--product-drift",
            "Relative variance per sample that a pixel may add by using its neighbour's product; "
            "0 = each its own",
            0, 100);
  app.value(render.sampling.candidates, "--candidates",
            "Candidates for each sample, of samplers that resample: bis-reject, bis-sir, ris", 1,
            4096);
  app.value(render.sampling.regions, "--regions", "Regions that two-stage divides the probe into",
            4, 1 << 20);
  app.value(render.sampling.pps_samples, "--pps-samples",
            "BRDF values that the sampler pps begins with at each point", 1, 4096);
}

} // namespace haarlight::tool
