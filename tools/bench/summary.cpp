#include <bench/summary.h>

#include <algorithm>
#include <cmath>

namespace haarlight::bench {
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

void judge(Verdict& verdict) {
  verdict.winner =
      *std::min_element(verdict.rows.begin(), verdict.rows.end(),
                        [](const Row* a, const Row* b) { return a->relmse < b->relmse; });
  const Row* product = row_of(verdict, "product");
  const Row* mis = row_of(verdict, "mis");
  if (product != nullptr && mis != nullptr && product->relmse > 0)
    verdict.product_over_mis = mis->relmse / product->relmse;
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
  std::for_each(verdicts.begin(), verdicts.end(), judge);
  return verdicts;
}

tool::Report describe(const std::vector<Verdict>& verdicts) {
  const bool rivals = std::any_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) {
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
    if (rivals)
      line.add("product_over_mis", verdict.product_over_mis);
  }
  return report;
}

} // namespace haarlight::bench
