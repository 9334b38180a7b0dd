#include <bench/report.h>

#include <html/page.h>

#include <wavelet/file/provenance.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace haarlight::bench {

using namespace html;

namespace {

/// Whether two rows were measured under the same conditions.
bool comparable(const Row& a, const Row& b) {
  if (a.brdf != b.brdf || a.probe != b.probe || a.scene != b.scene || a.points != b.points ||
      a.mode != b.mode)
    return false;
  return a.mode == "equal-time" ? a.budget_seconds == b.budget_seconds : a.spp == b.spp;
}

const Row* row_of(const Verdict& verdict, const std::string& sampler) {
  const auto place = std::find_if(verdict.rows.begin(), verdict.rows.end(),
                                  [&](const Row* row) { return row->sampler == sampler; });
  return place == verdict.rows.end() ? nullptr : *place;
}

void find_winner(Verdict& verdict) {
  verdict.winner =
      *std::min_element(verdict.rows.begin(), verdict.rows.end(),
                        [](const Row* a, const Row* b) { return a->relmse < b->relmse; });
  const Row* product = row_of(verdict, "product");
  const Row* mis = row_of(verdict, "mis");
  if (product != nullptr && mis != nullptr && product->relmse > 0)
    verdict.product_over_mis = mis->relmse / product->relmse;
}

/// Verdicts of one mode by pair, in increasing order of budget or samples.
using Pairs = std::vector<std::vector<const Verdict*>>;

std::string pair_key(const Row& row) {
  return row.brdf + '\n' + row.probe + '\n' + row.scene + '\n' + row.points;
}

Pairs pairs_of(const std::vector<Verdict>& verdicts, const std::string& mode) {
  Pairs pairs;
  std::map<std::string, std::size_t> places;
  for (const Verdict& verdict : verdicts) {
    if (verdict.winner->mode != mode)
      continue;
    const auto [place, added] = places.emplace(pair_key(*verdict.winner), pairs.size());
    if (added)
      pairs.emplace_back();
    pairs[place->second].push_back(&verdict);
  }
  return pairs;
}

std::vector<std::string> level_names(const Plan& plan, const std::string& mode) {
  std::vector<std::string> names;
  if (mode == "equal-time" && !plan.seconds.empty())
    for (const double seconds : plan.seconds)
      names.push_back(number_html(seconds) + " s");
  else
    for (const int spp : plan.spps)
      names.push_back((mode == "equal-time" ? "time of " : "") + std::to_string(spp) + " spp");
  return names;
}

std::string winners_table(const Plan& plan, const Pairs& pairs, const std::string& mode) {
  TableRow groups = {{"", Cell::Style::Text, 4}};
  TableRow head = {{"BRDF"}, {"probe"}, {"scene"}, {"points"}};
  for (const std::string& level : level_names(plan, mode)) {
    groups.push_back(group_cell(level, 3));
    head.insert(head.end(), {{"winner"}, number_cell("relMSE"), number_cell("mis ÷ product")});
  }
  std::vector<TableRow> rows;
  for (const auto& pair : pairs) {
    const Row& first = *pair.front()->winner;
    TableRow& row = rows.emplace_back();
    for (const std::string& text : {first.brdf, first.probe, first.scene, first.points})
      row.push_back({escaped(text)});
    for (const Verdict* verdict : pair)
      row.insert(row.end(), {{sampler_html(verdict->winner->sampler)},
                             number_cell(number_html(verdict->winner->relmse)),
                             number_cell(number_html(verdict->product_over_mis))});
  }
  return table({groups, head}, rows);
}

/// Summary of a sampler over all pairs.
struct Standing {
  double log_ratio = 0; ///< sum of log(error / error of the base)
  int count = 0;
  int wins = 0;
};

/// At the largest budget or number of samples of every pair.
std::map<std::string, Standing> standings(const Pairs& pairs, const std::string& base) {
  std::map<std::string, Standing> result;
  for (const auto& pair : pairs) {
    const Verdict& verdict = *pair.back();
    double base_error = unknown;
    for (const Row* row : verdict.rows)
      if (row->sampler == base)
        base_error = row->relmse;
    for (const Row* row : verdict.rows) {
      Standing& standing = result[row->sampler];
      standing.wins += row == verdict.winner ? 1 : 0;
      if (row->relmse > 0 && base_error > 0) {
        standing.log_ratio += std::log(row->relmse / base_error);
        ++standing.count;
      }
    }
  }
  return result;
}

void add_standing(const std::map<std::string, Standing>& standings, const std::string& sampler,
                  TableRow& row) {
  const auto place = standings.find(sampler);
  if (place == standings.end()) {
    row.insert(row.end(), 2, number_cell("–"));
    return;
  }
  const Standing& s = place->second;
  const double ratio = s.count > 0 ? std::exp(s.log_ratio / s.count) : unknown;
  row.push_back(number_cell(number_html(ratio)));
  row.push_back(number_cell(std::to_string(s.wins)));
}

std::string standings_table(const Plan& plan, const Pairs& time, const Pairs& samples) {
  const std::string base = renderer::sampler_name(plan.samplers.front());
  const auto by_time = standings(time, base);
  const auto by_samples = standings(samples, base);
  const TableRow groups = {{""}, group_cell("equal time", 2), group_cell("equal samples", 2), {""}};
  const Cell ratio = number_cell("relMSE ÷ " + base + "’s");
  const TableRow head = {{"sampler"},         ratio,         number_cell("wins"), ratio,
                         number_cell("wins"), {"draws from"}};
  std::vector<TableRow> rows;
  for (const renderer::SamplerKind kind : plan.samplers) {
    const std::string name = renderer::sampler_name(kind);
    TableRow& row = rows.emplace_back();
    row.push_back({sampler_html(name)});
    add_standing(by_time, name, row);
    add_standing(by_samples, name, row);
    row.push_back({escaped(renderer::traits(kind).summary)});
  }
  return table({groups, head}, rows);
}

std::string overview_html(const Plan& plan, const std::vector<Verdict>& verdicts) {
  const Pairs time = pairs_of(verdicts, "equal-time");
  const Pairs samples = pairs_of(verdicts, "equal-samples");
  return "<h2>All pairs</h2>\n<p>Geometric mean over the pairs of each sampler's error relative "
         "to that of " +
         renderer::sampler_name(plan.samplers.front()) +
         ", and the number of pairs in which it has the smallest error, at the largest budget and "
         "number of samples.</p>\n" +
         standings_table(plan, time, samples) +
         "<h3>Winners at equal time</h3>\n<p>mis ÷ product: the error of mis divided by that of "
         "product.</p>\n" +
         winners_table(plan, time, "equal-time") + "<h3>Winners at equal samples</h3>\n" +
         winners_table(plan, samples, "equal-samples");
}

constexpr const char* definitions = R"(<h2>Definitions</h2>
<ul>
<li>All errors are of luminance, over the pixels that hit an object. With x a pixel, r its
reference and ε = (1 % of the mean of r)²: <b>relMSE</b> is the mean of (x − r)² / (r² + ε) over
pixels and seeds, minus the error of the reference itself, which is estimated from the spread of its
independent runs; ± is the standard error over the seeds.</li>
<li><b>Variance of a sample</b>: the mean of spp · Var / (r² + ε), where Var is the variance of the
pixel's mean as estimated within a run, assuming independent samples; it measures the choice of
directions, not the distribution of the points.</li>
<li><b>Mean ÷ reference</b>: the sum of all pixels over that of the reference, with its standard
error; red where it differs from 1 by more than four standard errors. Samplers that miss rare bright
events appear darker and less noisy than they are. Samplers tagged biased do not converge to the
reference.</li>
<li><b>Slope</b> of log relMSE over log spp: −1 where errors decrease as 1/N.</li>
<li><b>Time</b> is CPU time summed over threads, the minimum over the seeds, with the preparation of
each pixel. <b>ns per sample</b> is the cost of one more sample, <b>µs per pixel</b> the preparation.
<b>Set-up</b> is done once for a scene after its files are read, <b>trees</b> once for a BRDF or
probe; neither counts in the comparison at equal time.</li>
<li><b>Equal time</b>: the budget is the time of the first sampler of the table for a number of
samples, or as given; every other sampler takes the number of samples that fits by its own measured
cost, at least one. The actual time is given beside it.</li>
</ul>
)";

std::string budgets_text(const Plan& plan) {
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
                     std::to_string(plan.scenes.size()) + " scenes. " + budgets_text(plan) + "; " +
                     std::to_string(plan.seeds) + " seeds from " + std::to_string(plan.seed) +
                     "; film of " + escaped(plan.size) + " pixels; estimator " +
                     renderer::estimator_name(plan.render.estimator) + ".";
  double noise = 0;
  for (const PairResult& pair : pairs)
    for (const Row& row : pair.rows)
      noise = std::max(noise, row.reference_relmse);
  return html + " Reference: " + renderer::sampler_name(plan.reference_sampler) + ", " +
         std::to_string(plan.reference_spp) + " Sobol points per pixel over " +
         std::to_string(reference_runs) + " runs with different seeds, relMSE at most " +
         number_html(noise) + ".</p>\n";
}

} // namespace

std::vector<Verdict> verdicts_of(const std::vector<Row>& rows) {
  std::vector<Verdict> verdicts;
  for (const Row& row : rows) {
    auto place = std::find_if(verdicts.begin(), verdicts.end(), [&](const Verdict& verdict) {
      return comparable(*verdict.rows.front(), row);
    });
    if (place == verdicts.end())
      place = verdicts.insert(verdicts.end(), Verdict());
    place->rows.push_back(&row);
  }
  std::for_each(verdicts.begin(), verdicts.end(), find_winner);
  return verdicts;
}

tool::Report describe(const std::vector<Verdict>& verdicts) {
  const bool compared = std::any_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) {
    return std::isfinite(verdict.product_over_mis);
  });
  tool::Report report;
  for (const Verdict& verdict : verdicts) {
    const Row& row = *verdict.winner;
    const bool time = row.mode == "equal-time";
    tool::Report& line = report.row(time ? "equal_time" : "equal_samples");
    line.add("brdf", row.brdf)
        .add("probe", row.probe)
        .add("scene", row.scene)
        .add("points", row.points);
    if (time)
      line.add("budget_seconds", row.budget_seconds);
    line.add("spp", row.spp)
        .add("winner", row.sampler)
        .add("claim", row.claim)
        .add("relmse", row.relmse);
    if (compared)
      line.add("product_over_mis", verdict.product_over_mis);
  }
  return report;
}

std::string page_html(const Plan& plan, const std::vector<PairResult>& pairs,
                      const std::vector<Verdict>& verdicts) {
  std::string body =
      "<h1>Samplers compared</h1>\n" + settings(plan, pairs) + overview_html(plan, verdicts);
  for (const PairResult& pair : pairs)
    body += pair_html(plan, pair);
  return report_page("haarbench", body + definitions);
}

} // namespace haarlight::bench
