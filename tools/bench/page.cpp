#include <bench/page.h>

#include <bench/overview.h>
#include <bench/pair_section.h>

#include <html/frame.h>
#include <html/text.h>

#include <wavelet/file/provenance.h>

namespace haarlight::bench {

using namespace html;

namespace {

constexpr const char* definitions = R"(<h2>What the figures are</h2>
<ul>
<li>All errors are of luminance, over the pixels that hit an object. With x a pixel, r its
reference and ε = (1 % of the mean of r)²: <b>relMSE</b> is the mean of (x − r)² / (r² + ε) over
pixels and seeds, less the reference's own share, which is estimated from the spread of its
independent runs; ± is the standard error over the seeds.</li>
<li><b>Variance of a sample</b>: the mean of spp · Var / (r² + ε), Var being the variance of the
pixel's mean as estimated within a run, which supposes independent samples; so it tells how well
directions are chosen, apart from how evenly points are spread.</li>
<li><b>Mean ÷ reference</b>: the sum of all pixels over that of the reference, with its standard
error; red where it is off by more than four of them. Samplers that miss rare bright events seem
darker and surer than they are. Those tagged biased do not converge to the reference.</li>
<li><b>Slope</b> of log relMSE over log spp: −1 where errors fall as 1/N.</li>
<li><b>Time</b> is CPU time summed over threads, the least of the seeds' runs, each pixel's
preparation included. <b>ns per sample</b> is what one more sample costs, <b>µs per pixel</b> the
preparation. <b>Set-up</b> is done once for a scene after its files are read, <b>trees</b> once for
a BRDF or probe; neither counts in the comparison at equal time.</li>
<li><b>Equal time</b>: the budget is what the first sampler of the table takes for a number of
samples, or as given; every other sampler gets the samples that fit, found from its own measured
costs, and at least one. Its true time stands beside.</li>
</ul>
)";

std::string seconds_or_spps(const Plan& plan) {
  std::string text;
  for (const int spp : plan.spps)
    text += (text.empty() ? "" : ", ") + std::to_string(spp);
  text += " samples per pixel";
  for (const double seconds : plan.seconds)
    text += ", " + number_html(seconds) + " s";
  return text;
}

std::string settings(const Plan& plan, const std::vector<PairResult>& pairs) {
  std::string html = "<p>" + escaped(version_text()) + ". " + std::to_string(plan.samplers.size()) +
                     " samplers, " + std::to_string(plan.brdfs.size()) + " BRDFs, " +
                     std::to_string(plan.probes.size()) + " probes, " +
                     std::to_string(plan.scenes.size()) + " scenes. " + seconds_or_spps(plan) +
                     "; " + std::to_string(plan.seeds) + " seeds from " +
                     std::to_string(plan.seed) + "; film of " + escaped(plan.size) +
                     " pixels; estimator " + renderer::estimator_name(plan.render.estimator) + ".";
  double noise = 0;
  for (const PairResult& pair : pairs)
    for (const Row& row : pair.rows)
      noise = std::max(noise, row.reference_relmse);
  return html + " Reference: " + renderer::sampler_name(plan.reference_sampler) + ", " +
         std::to_string(plan.reference_spp) + " Sobol points per pixel over " +
         std::to_string(reference_runs) + " runs with seeds of their own, relMSE at most " +
         number_html(noise) + ".</p>\n";
}

} // namespace

std::string page_html(const Plan& plan, const std::vector<PairResult>& pairs,
                      const std::vector<Verdict>& verdicts) {
  std::string body =
      "<h1>Samplers compared</h1>\n" + settings(plan, pairs) + overview_html(plan, verdicts);
  for (const PairResult& pair : pairs)
    body += pair_html(plan, pair);
  return framed("haarbench", body + definitions);
}

} // namespace haarlight::bench
