#include <bench/measure.h>

#include <render/film_output.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <map>
#include <memory>

namespace haarlight::bench {

using namespace renderer;

namespace {

/// Runs that differ in their seed only.
struct Runs {
  int spp = 0;
  std::vector<Pixels> luminances;  ///< of the pixels that hit an object
  Pixels variances;                ///< of those, of one run's mean: estimated within the runs
  double seconds = 0;              ///< CPU time of a picture: the least of the runs
  Image first;                     ///< of the first seed
  Image mean;                      ///< of all
  std::vector<std::size_t> pixels; ///< indices in the film of those that hit an object
};

class Session {
public:
  /// @param options with sampler and estimator
  Session(const SceneDescription& description, const RenderOptions& options);

  /// @param seed,count seeds seed, seed + 1, …
  Runs run(Points points, int spp, std::uint32_t seed, int count) const;

  /// The cost of a picture by spp, from these runs; if all have the same spp, others are rendered.
  CostModel cost(Points points, std::uint32_t seed, int count, const std::vector<Runs>& all) const;

  /// Runs with about the largest number of samples that fit a budget, CPU seconds of a picture. The
  /// preparation may depend on the number of samples, so each run refines the cost model.
  Runs run_within(double budget, Points points, std::uint32_t seed, int count,
                  CostModel& cost) const;

  /// CPU seconds once per scene, after its files are read.
  double setup_seconds() const { return m_setup_seconds; }

  const LoadedScene& scene() const { return *m_scene; }

private:
  RenderOptions m_options;
  std::unique_ptr<LoadedScene> m_scene;
  std::unique_ptr<RenderFactories> m_factories;
  double m_setup_seconds = 0;
};

std::vector<std::size_t> hit_pixels(const Film& film) {
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < film.count(); ++i)
    if (film.samples[i] > 0)
      pixels.push_back(i);
  return pixels;
}

Pixels luminances_of(const Film& film, const std::vector<std::size_t>& pixels) {
  Pixels result;
  result.reserve(pixels.size());
  for (const std::size_t i : pixels)
    result.push_back(static_cast<double>(luminance(film.color(i))));
  return result;
}

void add(const std::vector<float>& rgb, float share, Image& mean) {
  for (std::size_t i = 0; i < rgb.size(); ++i)
    mean.rgb[i] += share * rgb[i];
}

void add_variances(const Film& film, const std::vector<std::size_t>& pixels, double share,
                   Pixels& variances) {
  variances.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    variances[i] += share * static_cast<double>(film.variance[pixels[i]]);
}

std::vector<double> seconds_of(const std::vector<Runs>& all) {
  std::vector<double> seconds;
  seconds.reserve(all.size());
  for (const Runs& runs : all)
    seconds.push_back(runs.seconds);
  return seconds;
}

Session::Session(const SceneDescription& description, const RenderOptions& options)
    : m_options(options),
      m_scene(std::make_unique<LoadedScene>(description, SourceLookups{}, options.sampler,
                                            needs_unshadowed(options.estimator))) {
  const std::clock_t start = std::clock();
  m_factories = std::make_unique<RenderFactories>(*m_scene, m_options);
  m_setup_seconds = m_scene->preparation_seconds() +
                    static_cast<double>(std::clock() - start) / static_cast<double>(CLOCKS_PER_SEC);
}

Runs Session::run(Points points, int spp, std::uint32_t seed, int count) const {
  Runs result;
  result.spp = spp;
  result.seconds = std::numeric_limits<double>::infinity();
  RenderOptions options = m_options;
  options.points = points;
  options.spp = spp;
  const SceneDescription& scene = m_scene->description();
  result.first = Image(scene.width, scene.height);
  result.mean = result.first;
  for (int k = 0; k < count; ++k) {
    options.seed = seed + static_cast<std::uint32_t>(k);
    const RenderResult rendered =
        render(*m_scene, *m_factories, options, scene.width, scene.height);
    if (k == 0) {
      result.pixels = hit_pixels(rendered.film);
      result.first.rgb = rendered.film.rgb;
    }
    add(rendered.film.rgb, 1.0F / static_cast<float>(count), result.mean);
    result.luminances.push_back(luminances_of(rendered.film, result.pixels));
    add_variances(rendered.film, result.pixels, 1.0 / count, result.variances);
    result.seconds = std::min(result.seconds, rendered.statistics.thread_seconds);
  }
  return result;
}

CostModel Session::cost(Points points, std::uint32_t seed, int count,
                        const std::vector<Runs>& all) const {
  CostModel cost;
  for (const Runs& runs : all)
    cost.add(runs.spp, runs.seconds);
  if (all.size() == 1) {
    const int pilot = all.front().spp > 1 ? std::max(1, all.front().spp / 8) : 8;
    cost.add(pilot, run(points, pilot, seed, count).seconds);
  }
  return cost;
}

Runs Session::run_within(double budget, Points points, std::uint32_t seed, int count,
                         CostModel& cost) const {
  constexpr int rounds = 3;
  constexpr int most_spp = 1 << 18;
  Runs runs;
  for (int round = 0; round < rounds; ++round) {
    const int spp = cost.affordable(budget, most_spp);
    if (spp == runs.spp)
      break;
    runs = run(points, spp, seed, count);
    cost.add(spp, runs.seconds);
  }
  return runs;
}

/// @param common the fields that all rows of a sampler share
/// @param mode   equal-samples or equal-time
Row row_of(const Row& common, const std::string& mode, const Runs& runs,
           const Reference& reference) {
  const Quality quality = quality_of(reference, runs.luminances);
  Row row = common;
  row.mode = mode;
  row.spp = runs.spp;
  row.seconds = runs.seconds;
  row.seed_count = static_cast<int>(runs.luminances.size());
  row.relmse = quality.relmse;
  row.relmse_stderr = quality.relmse_stderr;
  row.reference_relmse = quality.reference_relmse;
  row.mean_ratio = quality.mean_ratio;
  row.mean_ratio_stderr = quality.mean_ratio_stderr;
  if (runs.spp > 1)
    row.relvar_per_sample = runs.spp * relative_mean(reference, runs.variances);
  const auto points = static_cast<double>(runs.pixels.size());
  row.seconds_per_point =
      std::max(0.0, row.seconds / points - runs.spp * common.seconds_per_sample);
  if (row.relmse * row.seconds > 0)
    row.efficiency = 1 / (row.relmse * row.seconds);
  return row;
}

/// Sets the slope of the error over the samples in all rows.
void set_slopes(std::vector<Row>& rows) {
  std::vector<double> spps;
  std::vector<double> errors;
  spps.reserve(rows.size());
  errors.reserve(rows.size());
  for (const Row& row : rows) {
    spps.push_back(row.spp);
    errors.push_back(row.relmse);
  }
  for (Row& row : rows)
    row.slope = log_slope(spps, errors);
}

/// First seed of the reference: apart from all others.
constexpr std::uint32_t reference_seeds = 0x80000000U;

class PairMeasurement {
public:
  PairMeasurement(const Plan& plan, const Entry& brdf, const Entry& probe, const std::string& scene,
                  const WorkDone& done)
      : m_plan(plan), m_brdf(brdf), m_probe(probe), m_scene(scene_of(scene)), m_done(done),
        m_seed(static_cast<std::uint32_t>(plan.seed)) {
    m_result.brdf = brdf.subject.name;
    m_result.probe = probe.subject.name;
    m_result.scene = scene_name(scene);
    tool::set_film_size(plan.size, m_scene);
  }

  PairResult run() {
    measure_reference();
    for (const SamplerKind kind : m_plan.samplers)
      measure_sampler(kind);
    return std::move(m_result);
  }

private:
  RenderOptions options_of(SamplerKind kind) const {
    RenderOptions options = m_plan.render;
    options.sampler = kind;
    return options;
  }

  void measure_reference() {
    const SamplerKind kind = m_plan.reference_sampler;
    RenderOptions options = options_of(kind);
    options.estimator = Estimator::Unbiased;
    const Session session(pair_scene(m_scene, m_brdf, m_probe, kind).description, options);
    m_result.light_note = session.scene().light().note();
    const int spp = m_plan.reference_spp / reference_runs;
    const Runs runs = session.run(Points::Sobol, spp, reference_seeds + m_seed, reference_runs);
    m_done(m_plan.reference_spp);
    if (runs.luminances.front().empty())
      throw_input_error(m_scene.path, "no pixel of the film hits an object");
    m_reference = reference_of(runs.luminances);
    m_result.reference = runs.mean;
    m_result.hit.assign(runs.mean.rgb.size() / 3, false);
    for (const std::size_t pixel : runs.pixels)
      m_result.hit[pixel] = true;
  }

  void measure_sampler(SamplerKind kind) {
    const PairScene scene = pair_scene(m_scene, m_brdf, m_probe, kind);
    const Session session(scene.description, options_of(kind));
    m_sampler = {};
    m_sampler.brdf = m_result.brdf;
    m_sampler.probe = m_result.probe;
    m_sampler.scene = m_result.scene;
    m_sampler.sampler = sampler_name(kind);
    m_sampler.claim = traits(kind).bias == Bias::Biased ? "biased" : "unbiased";
    m_sampler.setup_seconds = session.setup_seconds();
    m_sampler.precompute_seconds = scene.precompute_seconds;
    for (const Points points : m_plan.points)
      measure_points(kind, session, points);
  }

  void measure_points(SamplerKind kind, const Session& session, Points points) {
    m_sampler.points = points == Points::Sobol ? "sobol" : "random";
    std::vector<Runs> all;
    for (const int spp : m_plan.spps) {
      all.push_back(session.run(points, spp, m_seed, m_plan.seeds));
      m_done(spp * m_plan.seeds);
    }
    CostModel cost = session.cost(points, m_seed, m_plan.seeds, all);
    m_sampler.seconds_per_sample =
        cost.seconds_per_spp() / static_cast<double>(m_reference.mean.size());
    add_equal_samples(all);
    std::vector<double>& budgets = m_budgets[points];
    const bool own = budgets.empty() && m_plan.seconds.empty();
    if (budgets.empty())
      budgets = own ? seconds_of(all) : m_plan.seconds;
    for (std::size_t i = 0; i < budgets.size(); ++i) {
      const Runs runs = own ? std::move(all[i])
                            : session.run_within(budgets[i], points, m_seed, m_plan.seeds, cost);
      const Row& row = add_equal_time(runs, budgets[i]);
      if (i == 0 && points == m_plan.points.front())
        m_result.exhibits.push_back({kind, runs.spp, row.relmse, runs.first});
      m_done(m_plan.spps[std::min(i, m_plan.spps.size() - 1)] * m_plan.seeds);
    }
  }

  void add_equal_samples(const std::vector<Runs>& all) {
    std::vector<Row> rows;
    rows.reserve(all.size());
    for (const Runs& runs : all)
      rows.push_back(row_of(m_sampler, "equal-samples", runs, m_reference));
    set_slopes(rows);
    m_result.rows.insert(m_result.rows.end(), rows.begin(), rows.end());
  }

  const Row& add_equal_time(const Runs& runs, double budget) {
    m_result.rows.push_back(row_of(m_sampler, "equal-time", runs, m_reference));
    m_result.rows.back().budget_seconds = budget;
    return m_result.rows.back();
  }

  const Plan& m_plan;
  const Entry& m_brdf;
  const Entry& m_probe;
  SceneDescription m_scene;
  const WorkDone& m_done;
  std::uint32_t m_seed;
  Reference m_reference;
  Row m_sampler; ///< fields that all rows of the current sampler share
  std::map<Points, std::vector<double>> m_budgets; ///< by the base sampler
  PairResult m_result;
};

} // namespace

PairResult measure_pair(const Plan& plan, const Entry& brdf, const Entry& probe,
                        const std::string& scene, const WorkDone& done) {
  return PairMeasurement(plan, brdf, probe, scene, done).run();
}

} // namespace haarlight::bench
