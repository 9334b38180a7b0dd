#include <bench/measure.h>

#include <bench/figures.h>
#include <bench/scenes.h>
#include <bench/session.h>

#include <render/film_output.h>

#include <wavelet/base/error.h>

#include <map>

namespace haarlight::bench {

using namespace renderer;

namespace {

/// Seeds of the reference lie apart from all others.
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
  Row m_sampler; ///< what all rows of the sampler at hand have in common
  std::map<Points, std::vector<double>> m_budgets; ///< by the base sampler
  PairResult m_result;
};

} // namespace

PairResult measure_pair(const Plan& plan, const Entry& brdf, const Entry& probe,
                        const std::string& scene, const WorkDone& done) {
  return PairMeasurement(plan, brdf, probe, scene, done).run();
}

} // namespace haarlight::bench
