// haarbench: compares samplers at equal samples and at equal time.
#include <bench/inputs.h>
#include <bench/measure.h>
#include <bench/plan.h>
#include <bench/report.h>
#include <html/page.h>
#include <render/film_output.h>
#include <support/progress.h>
#include <support/tool.h>

#include <wavelet/base/error.h>

#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

using namespace haarlight;
using namespace haarlight::bench;

namespace {

/// The output folder, its cache and their parents. Folders created here that are still empty at the
/// end, because the run failed early, are removed.
class OutputFolders {
public:
  OutputFolders() = default;
  OutputFolders(const OutputFolders&) = delete;
  OutputFolders& operator=(const OutputFolders&) = delete;
  ~OutputFolders() {
    for (auto folder = m_made.rbegin(); folder != m_made.rend(); ++folder)
      ::rmdir(folder->c_str()); // fails unless it is empty
  }

  /// Creates the folders; throws if nothing can be written there.
  void make(const tool::Tool& app, const std::string& folder) {
    std::filesystem::path parent;
    for (const std::filesystem::path& name : std::filesystem::path(folder) / "cache") {
      parent /= name;
      std::error_code problem;
      if (std::filesystem::is_directory(parent, problem))
        continue;
      if (std::filesystem::create_directory(parent, problem))
        m_made.push_back(parent);
      if (problem)
        throw_output_error(folder, "cannot be created as a folder: " + problem.message());
    }
    for (const char* name : {"/results.json", "/results.csv", "/report.html"}) {
      app.writes("--output", folder + name);
      const OutputFile trial(folder + name);
    }
  }

private:
  std::vector<std::filesystem::path> m_made; ///< parents first
};

/// Reports a malformed scene before any long work.
void check_scenes(const tool::Tool& app, const Plan& plan) {
  for (const std::string& word : plan.scenes) {
    renderer::SceneDescription scene = scene_of(word);
    tool::set_film_size(plan.size, scene);
    tool::check_sources(app, scene);
  }
}

std::vector<Row> rows_of(const std::vector<PairResult>& pairs) {
  std::vector<Row> rows;
  for (const PairResult& pair : pairs)
    rows.insert(rows.end(), pair.rows.begin(), pair.rows.end());
  return rows;
}

void write_rows(const Plan& plan, const std::vector<PairResult>& pairs) {
  const std::vector<Row> rows = rows_of(pairs);
  html::write_text(plan.folder + "/results.json", json_text(rows));
  html::write_text(plan.folder + "/results.csv", csv_text(rows));
}

/// Writes the rows after each pair, so that an interrupted run keeps those of finished pairs.
std::vector<PairResult> measure_all(const tool::Tool& app, const Plan& plan,
                                    const Collection& collection) {
  const std::size_t count = collection.brdfs.size() * collection.probes.size() * plan.scenes.size();
  const double total = work_units(plan) * static_cast<double>(count);
  double done = 0;
  tool::ProgressBar bar(app, "measuring");
  const WorkDone work = [&](double units) {
    done += units;
    bar(static_cast<int>(10000 * std::min(1.0, done / total)), 10000);
  };
  std::vector<PairResult> pairs;
  for (const Entry& brdf : collection.brdfs)
    for (const Entry& probe : collection.probes)
      for (const std::string& scene : plan.scenes) {
        pairs.push_back(measure_pair(plan, brdf, probe, scene, work));
        write_rows(plan, pairs);
        const PairResult& pair = pairs.back();
        if (!pair.light_note.empty())
          app.detail(probe.subject.path + ": " + pair.light_note);
        app.detail(pair.brdf + ", " + pair.probe + ", " + pair.scene + ": done");
      }
  return pairs;
}

int compare_samplers(const tool::Tool& app, Plan& plan) {
  check(plan);
  check_scenes(app, plan);
  Collection collection = open_subjects(plan);
  OutputFolders folders;
  folders.make(app, plan.folder);
  make_trees(plan, Cache(app, plan.folder + "/cache", plan.cache), collection);
  const std::vector<PairResult> pairs = measure_all(app, plan, collection);
  const std::vector<Row> rows = rows_of(pairs); // verdicts point into them
  const std::vector<Verdict> verdicts = verdicts_of(rows);
  html::write_text(plan.folder + "/report.html", page_html(plan, pairs, verdicts));
  app.print(describe(verdicts));
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command(
          "haarbench",
          "Renders every BRDF under every probe with every sampler, at equal samples and at equal "
          "time, and reports errors and costs; tools/HAARBENCH.md defines the figures.",
          declare, compare_samplers));
}
