#include <bench/overview.h>

#include <bench/look.h>

#include <html/cells.h>
#include <html/text.h>

#include <cmath>
#include <map>

namespace haarlight::bench {

using namespace html;

namespace {

/// Verdicts of one mode by pair, each pair's by rising level.
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
  std::string html = "<table><thead><tr><th colspan=\"4\"></th>";
  const std::vector<std::string> levels = level_names(plan, mode);
  for (const std::string& level : levels)
    html += group_head(level, 3);
  html += "</tr><tr>";
  for (const char* name : {"BRDF", "probe", "scene", "points"})
    html += text_head(name);
  for (std::size_t i = 0; i < levels.size(); ++i)
    html += text_head("winner") + figure_head("relMSE") + figure_head("mis ÷ product");
  html += "</tr></thead><tbody>\n";
  for (const auto& pair : pairs) {
    const Row& row = *pair.front()->winner;
    html += "<tr>";
    for (const std::string& text : {row.brdf, row.probe, row.scene, row.points})
      html += text_cell(escaped(text));
    for (const Verdict* verdict : pair)
      html += text_cell(sampler_html(verdict->winner->sampler)) +
              figure_cell(number_html(verdict->winner->relmse)) +
              figure_cell(number_html(verdict->product_over_mis));
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

/// How a sampler does over many verdicts.
struct Standing {
  double log_ratio = 0; ///< summed: error over that of the base
  int count = 0;
  int wins = 0;
};

/// At the last level of every pair.
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

std::string standing_cells(const std::map<std::string, Standing>& standings,
                           const std::string& sampler) {
  const auto place = standings.find(sampler);
  if (place == standings.end())
    return figure_cell("–") + figure_cell("–");
  const Standing& s = place->second;
  const double ratio = s.count > 0 ? std::exp(s.log_ratio / s.count) : unknown;
  return figure_cell(number_html(ratio)) + figure_cell(std::to_string(s.wins));
}

std::string standings_table(const Plan& plan, const Pairs& time, const Pairs& samples) {
  const std::string base = renderer::sampler_name(plan.samplers.front());
  const auto by_time = standings(time, base);
  const auto by_samples = standings(samples, base);
  std::string html = "<table><thead><tr>" + text_head("") + group_head("equal time", 2) +
                     group_head("equal samples", 2) + text_head("") + "</tr><tr>" +
                     text_head("sampler");
  for (int i = 0; i < 2; ++i)
    html += figure_head("relMSE ÷ " + base + "’s") + figure_head("wins");
  html += text_head("draws from") + "</tr></thead><tbody>\n";
  for (const renderer::SamplerKind kind : plan.samplers) {
    const std::string name = renderer::sampler_name(kind);
    html += "<tr>" + text_cell(sampler_html(name)) + standing_cells(by_time, name) +
            standing_cells(by_samples, name) + text_cell(escaped(renderer::traits(kind).summary)) +
            "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

} // namespace

std::string overview_html(const Plan& plan, const std::vector<Verdict>& verdicts) {
  const Pairs time = pairs_of(verdicts, "equal-time");
  const Pairs samples = pairs_of(verdicts, "equal-samples");
  return "<h2>All pairs</h2>\n<p>Geometric mean over the pairs of each sampler's error in units "
         "of that of " +
         renderer::sampler_name(plan.samplers.front()) +
         ", and how often it wins, at the largest budget and number of samples.</p>\n" +
         standings_table(plan, time, samples) +
         "<h3>Winners at equal time</h3>\n<p>mis ÷ product: how many times larger the error of "
         "mis is.</p>\n" +
         winners_table(plan, time, "equal-time") + "<h3>Winners at equal samples</h3>\n" +
         winners_table(plan, samples, "equal-samples");
}

} // namespace haarlight::bench
