// Opening .haar files, and packing and unpacking them.
// Usage: file_bench FILE.haar [options of the benchmark library]
#include <wavelet/file/tree_set.h>
#include <wavelet/transform/compress.h>

#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// A set of one constant map.
class EmptySource : public MapSource {
public:
  EmptySource() { m_info.size = 4; }
  const SetInfo& info() const override { return m_info; }
  Map make(int /*column*/, int /*row*/) const override { return Map(4); }

private:
  SetInfo m_info;
};

void open_set(benchmark::State& state, const std::string& path, Check check) {
  for (auto _ : state) {
    const TreeSet set(path, check);
    benchmark::DoNotOptimize(set.levels());
  }
}

void open_and_read_one(benchmark::State& state, const std::string& path) {
  for (auto _ : state) {
    const TreeSet set(path, Check::WhenUsed);
    const TreeView& tree = set.tree(set.info().columns / 2, set.info().rows / 2);
    benchmark::DoNotOptimize(tree.value(0.3F, 0.4F));
  }
}

void convert(benchmark::State& state, const std::string& from, const std::string& to,
             void (*conversion)(const std::string&, OutputFile&, const Progress&)) {
  for (auto _ : state) {
    OutputFile file(to);
    conversion(from, file, {});
    state.counters["bytes"] = static_cast<double>(file.position());
    file.commit();
  }
}

void add_benchmarks(const std::string& path, const std::string& folder) {
  const std::string empty = folder + "/empty.haar";
  const std::string packed = folder + "/packed.haar";
  OutputFile file(empty);
  compress_set(EmptySource(), {}, file);
  file.commit();
  const auto add = [](const char* name, auto function, auto... arguments) {
    benchmark::RegisterBenchmark(name, function, arguments...)->Unit(benchmark::kMillisecond);
  };
  add("open an empty set", open_set, empty, Check::Everything);
  add("open", open_set, path, Check::WhenUsed);
  add("open, one tree", open_and_read_one, path);
  add("open, check everything", open_set, path, Check::Everything);
  add("pack", convert, path, packed, pack);
  add("unpack", convert, packed, folder + "/mapped.haar", unpack);
}

} // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2) {
    std::fprintf(stderr, "usage: file_bench FILE.haar\n");
    return 2;
  }
  const auto folder = std::filesystem::temp_directory_path() / "haarlight-file-bench";
  std::filesystem::create_directories(folder);
  add_benchmarks(argv[1], folder.string());
  benchmark::RunSpecifiedBenchmarks();
  std::filesystem::remove_all(folder);
}
