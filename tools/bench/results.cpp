#include <bench/results.h>

#include <support/report.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace haarlight::bench {
namespace {

double sum(const Pixels& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Mean and variance of the mean of values.
struct Spread {
  double mean = 0;
  double variance = 0;
};

template <class Value>
Spread spread_of(std::size_t count, Value value) {
  Spread result;
  const auto n = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i)
    result.mean += value(i) / n;
  for (std::size_t i = 0; i < count; ++i) {
    const double deviation = value(i) - result.mean;
    result.variance += deviation * deviation / (n * (n - 1));
  }
  return result;
}

Spread pixel_spread(std::span<const Pixels> runs, std::size_t pixel) {
  return spread_of(runs.size(), [&](std::size_t run) { return runs[run][pixel]; });
}

double squared_error(const Reference& reference, const Pixels& run) {
  double total = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double error = run[i] - reference.mean[i];
    total += error * error / reference.square(i);
  }
  return run.empty() ? 0 : total / static_cast<double>(run.size());
}

/// Variance of Σ x averaged over the runs: pixels are independent of each other.
double variance_of_sum(std::span<const Pixels> runs) {
  double total = 0;
  for (std::size_t i = 0; i < runs.front().size(); ++i)
    total += pixel_spread(runs, i).variance;
  return total;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos)
    return text;
  std::string result = "\"";
  for (const char c : text)
    result.append(c == '"' ? 2 : 1, c);
  return result.append("\"");
}

std::string csv_value(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value))
    return quoted(*text);
  if (const auto* number = std::get_if<std::int64_t>(&value))
    return std::to_string(*number);
  const double real = std::get<double>(value);
  return std::isfinite(real) ? tool::exact_text(real) : std::string();
}

} // namespace

Reference reference_of(std::span<const Pixels> runs) {
  assert(runs.size() >= 2);
  Reference result;
  for (std::size_t i = 0; i < runs.front().size(); ++i) {
    const Spread spread = pixel_spread(runs, i);
    result.mean.push_back(spread.mean);
    result.noise.push_back(spread.variance);
  }
  const double mean = sum(result.mean) / std::max(1.0, static_cast<double>(result.mean.size()));
  result.floor = 1e-4 * mean * mean;
  return result;
}

double relative_mean(const Reference& reference, const Pixels& variances) {
  double total = 0;
  for (std::size_t i = 0; i < variances.size(); ++i)
    total += variances[i] / reference.square(i);
  return variances.empty() ? 0 : total / static_cast<double>(variances.size());
}

Quality quality_of(const Reference& reference, std::span<const Pixels> runs) {
  assert(runs.size() >= 2);
  Quality result;
  result.reference_relmse = relative_mean(reference, reference.noise);
  const Spread errors =
      spread_of(runs.size(), [&](std::size_t run) { return squared_error(reference, runs[run]); });
  result.relmse = std::max(0.0, errors.mean - result.reference_relmse);
  result.relmse_stderr = std::sqrt(errors.variance);
  const double truth = sum(reference.mean);
  double total = 0;
  for (const Pixels& run : runs)
    total += sum(run) / static_cast<double>(runs.size());
  result.mean_ratio = total / truth;
  const double relative_noise = sum(reference.noise) * result.mean_ratio * result.mean_ratio;
  result.mean_ratio_stderr = std::sqrt(variance_of_sum(runs) + relative_noise) / truth;
  return result;
}

double log_slope(std::span<const double> x, std::span<const double> y) {
  std::vector<double> u;
  std::vector<double> v;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i] > 0 && y[i] > 0) {
      u.push_back(std::log(x[i]));
      v.push_back(std::log(y[i]));
    }
  const auto n = static_cast<double>(u.size());
  const double mean_u = sum(u) / n;
  const double mean_v = sum(v) / n;
  double across = 0;
  double along = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    across += (u[i] - mean_u) * (v[i] - mean_v);
    along += (u[i] - mean_u) * (u[i] - mean_u);
  }
  return along > 0 ? across / along : std::numeric_limits<double>::quiet_NaN();
}

/// Samples are assumed to take at least this fraction of the time of the longest run, since the
/// clock's noise may exceed their cost if preparation is long.
constexpr double min_sample_fraction = 0.05;

void CostModel::add(int spp, double seconds) {
  const Point point{static_cast<double>(spp), seconds};
  const auto place = std::lower_bound(m_points.begin(), m_points.end(), point.spp,
                                      [](const Point& p, double s) { return p.spp < s; });
  if (place == m_points.end() || place->spp != point.spp)
    m_points.insert(place, point);
}

double CostModel::seconds_per_spp() const {
  assert(m_points.size() >= 2);
  const Point& first = m_points.front();
  const Point& last = m_points.back();
  return std::max(min_sample_fraction * last.seconds / last.spp,
                  (last.seconds - first.seconds) / (last.spp - first.spp));
}

int CostModel::affordable(double seconds, int most) const {
  assert(m_points.size() >= 2);
  std::size_t i = 1;
  while (i + 1 < m_points.size() && m_points[i].seconds < seconds)
    ++i;
  const Point& low = m_points[i - 1];
  const Point& high = m_points[i];
  const double slope =
      std::max((high.seconds - low.seconds) / (high.spp - low.spp), seconds_per_spp() / 4);
  if (!(slope > 0)) // nothing took any time
    return most;
  const double spp = low.spp + (seconds - low.seconds) / slope;
  return static_cast<int>(std::clamp(std::floor(spp + 1e-9), 1.0, static_cast<double>(most)));
}

std::vector<std::pair<std::string, Value>> fields_of(const Row& row) {
  return {{"brdf", row.brdf},
          {"probe", row.probe},
          {"scene", row.scene},
          {"sampler", row.sampler},
          {"points", row.points},
          {"spp", std::int64_t{row.spp}},
          {"seconds", row.seconds},
          {"seed_count", std::int64_t{row.seed_count}},
          {"relmse", row.relmse},
          {"relvar_per_sample", row.relvar_per_sample},
          {"mean_ratio", row.mean_ratio},
          {"mean_ratio_stderr", row.mean_ratio_stderr},
          {"seconds_per_sample", row.seconds_per_sample},
          {"setup_seconds", row.setup_seconds},
          {"mode", row.mode},
          {"budget_seconds", row.budget_seconds},
          {"efficiency", row.efficiency},
          {"slope", row.slope},
          {"relmse_stderr", row.relmse_stderr},
          {"reference_relmse", row.reference_relmse},
          {"seconds_per_point", row.seconds_per_point},
          {"precompute_seconds", row.precompute_seconds},
          {"claim", row.claim}};
}

std::string json_text(const std::vector<Row>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    nlohmann::ordered_json object;
    for (const auto& [name, value] : fields_of(row))
      std::visit([&, &key = name](const auto& v) { object[key] = v; }, value);
    list.push_back(std::move(object));
  }
  return list.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

std::string csv_text(const std::vector<Row>& rows) {
  std::string text;
  for (const auto& [name, value] : fields_of({}))
    text.append(text.empty() ? "" : ",").append(name);
  text += '\n';
  for (const Row& row : rows) {
    std::string line;
    for (const auto& [name, value] : fields_of(row))
      line.append(name == "brdf" ? "" : ",").append(csv_value(value));
    text.append(line).append("\n");
  }
  return text;
}

} // namespace haarlight::bench
