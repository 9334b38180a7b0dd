#pragma once
// The comparisons that haarbench is to make.

#include <bench/inputs.h>
#include <support/tool.h>

#include <renderer/film/render.h>

#include <cstdint>
#include <string>
#include <vector>

namespace haarlight::bench {

enum class PointChoice { Random, Sobol, Both };

/// The command line of haarbench; check() completes it.
struct Plan {
  std::vector<std::string> brdfs;
  std::vector<std::string> probes;
  std::vector<std::string> scenes;
  std::string folder;
  std::vector<renderer::SamplerKind> samplers; ///< the first is the base of equal times
  std::vector<int> spps = {16, 64, 256};       ///< rising
  std::vector<double> seconds;                 ///< rising; empty: the base's own times
  std::string size = "64x64";
  PointChoice point_choice = PointChoice::Sobol;
  int seeds = 4;
  std::uint64_t seed = 0;
  int reference_spp = 4096;
  renderer::SamplerKind reference_sampler = renderer::SamplerKind::Product;
  renderer::RenderOptions render; ///< estimator and sampling options that all runs share
  CacheOptions cache;

  std::vector<renderer::Points> points;
};

/// Independent runs whose average is the reference.
inline constexpr int reference_runs = 8;

/// Declares all options.
void declare(tool::Tool& app, Plan& plan);

/// Completes the plan. @throws UsageError for contradictory or invalid options
void check(Plan& plan);

/// Units of work of one pair: approximately the samples per pixel of all runs.
double work_units(const Plan& plan);

/// The file name of a path without its extension.
std::string stem_of(const std::string& path);

} // namespace haarlight::bench
