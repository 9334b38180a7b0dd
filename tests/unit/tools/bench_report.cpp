// The command line of haarbench, and its reports.
#include <bench/plan.h>
#include <bench/report.h>
#include <bench/results.h>

#include <html/plot.h>

#include <catch2/catch.hpp>

#include <optional>

using namespace haarlight;
using namespace haarlight::bench;
using namespace haarlight::html;

namespace {

Row row(const std::string& sampler, double relmse, int spp = 16) {
  Row result;
  result.brdf = std::string("a");
  result.probe = std::string("p");
  result.scene = std::string("sphere");
  result.points = std::string("sobol");
  result.mode = std::string("equal-samples");
  result.sampler = sampler;
  result.relmse = relmse;
  result.spp = spp;
  return result;
}

/// The plan that haarbench makes of its command line; nothing if it refuses it.
std::optional<Plan> plan_of(std::vector<const char*> words) {
  const std::vector<const char*> rest = {"--brdf", "a.binary", "--probe", "p.hdr", "-o", "out"};
  words.insert(words.begin(), "haarbench");
  words.insert(words.end(), rest.begin(), rest.end());
  tool::Tool app("haarbench", "Tests.");
  Plan plan;
  declare(app, plan);
  const int code = app.run(static_cast<int>(words.size()), words.data(), [&] {
    check(plan);
    return tool::exit_ok;
  });
  return code == tool::exit_ok ? std::optional(plan) : std::nullopt;
}

} // namespace

TEST_CASE("lists may be given by commas or one by one", "[bench]") {
  using renderer::SamplerKind;
  const auto plan = plan_of({"--samplers", "mis,product", "mis", "--spp", "64", "4,16", "4"});
  REQUIRE(plan);
  CHECK(plan->samplers == std::vector{SamplerKind::Product, SamplerKind::Mis});
  CHECK(plan->spps == std::vector{4, 16, 64});
  CHECK(plan_of({"--samplers", "all"})->samplers.size() == renderer::samplers().size());
  CHECK(plan_of({})->spps == std::vector{16, 64, 256});
  CHECK(plan_of({"--seconds", "0.5,0.25"})->seconds == std::vector{0.25, 0.5});
  CHECK_FALSE(plan_of({"--samplers", "magic"}));
  CHECK_FALSE(plan_of({"--samplers", "mis,"}));
  CHECK_FALSE(plan_of({"--spp", "0"}));
  CHECK_FALSE(plan_of({"--spp", "4,"}));
}

TEST_CASE("names are those of the files, and must differ", "[bench]") {
  CHECK(stem_of("x/y.z/chrome.binary") == "chrome");
  CHECK(stem_of("plain") == "plain");
  CHECK(stem_of(".hidden") == ".hidden");
  Plan plan;
  plan.brdfs = {"x/a.binary", "y/a.binary"};
  plan.probes = {"p.hdr"};
  CHECK_THROWS_AS(check(plan), tool::UsageError);
}

TEST_CASE("rows are the same as JSON and as CSV", "[bench]") {
  Row odd = row("mis", 0.25);
  odd.brdf = std::string("a, \"b\"");
  const std::string json = json_text({odd});
  const std::string csv = csv_text({odd});
  CHECK(json.find("\"brdf\": \"a, \\\"b\\\"\"") != std::string::npos);
  CHECK(json.find("\"relmse\": 0.25") != std::string::npos);
  CHECK(json.find("\"slope\": null") != std::string::npos);
  CHECK(csv.rfind("brdf,probe,scene,sampler,points,spp,seconds,seed_count,relmse,"
                  "relvar_per_sample,mean_ratio,mean_ratio_stderr,seconds_per_sample,"
                  "setup_seconds,mode,",
                  0) == 0);
  CHECK(csv.find("\n\"a, \"\"b\"\"\",p,sphere,mis,sobol,16,0,0,0.25,,0,") != std::string::npos);
}

TEST_CASE("the least error wins, among what is comparable", "[bench]") {
  const std::vector<Row> rows = {row("product", 0.1), row("mis", 0.4), row("light", 0.05),
                                 row("product", 0.02, 64), row("mis", 0.1, 64)};
  const std::vector<Verdict> verdicts = verdicts_of(rows);
  REQUIRE(verdicts.size() == 2);
  CHECK(verdicts[0].winner->sampler == "light");
  CHECK(verdicts[0].product_over_mis == Approx(4));
  CHECK(verdicts[1].winner->sampler == "product");
  CHECK(verdicts[1].product_over_mis == Approx(5));
}

TEST_CASE("plots hold what can be shown on logarithmic axes", "[bench]") {
  const PlotStyle style = style_of(renderer::SamplerKind::Mis);
  const std::string plot =
      log_plot({{"a<b", style, {{16, 0.1}, {64, 0}, {256, 0.001}}}, {"absent", style, {{16, 0}}}},
               {"Title", "x", "y"});
  CHECK(plot.find("a&lt;b") != std::string::npos);
  CHECK(plot.find("absent") == std::string::npos);
  for (const std::string& text : {plot, log_plot({}, {}), log_plot({{"one", style, {{1, 1}}}}, {})})
    CHECK((text.find("nan") == std::string::npos && text.find("inf") == std::string::npos));
}

TEST_CASE("pictures are PNG files in the text", "[bench]") {
  PairResult pair;
  pair.reference = Image(4, 2);
  pair.hit.assign(8, true);
  const std::string head = "data:image/png;base64,iVBORw0KGgo";
  CHECK(picture_uri(pair, pair.reference).rfind(head, 0) == 0);
  CHECK(error_uri(pair, pair.reference).rfind(head, 0) == 0);
  CHECK(legend_uri().rfind(head, 0) == 0);
}
