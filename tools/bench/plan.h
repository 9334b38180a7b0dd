#pragma once
// What haarbench is asked to do.

#include <bench/cache.h>
#include <support/tool.h>

#include <renderer/film/render.h>

#include <cstdint>
#include <string>
#include <vector>

namespace haarlight::bench {

enum class PointChoice { Random, Sobol, Both };

/// As on the command line; check() makes the lists of words into those of numbers and kinds.
struct Plan {
  std::vector<std::string> brdfs;
  std::vector<std::string> probes;
  std::vector<std::string> scenes;
  std::string folder;
  std::vector<std::string> sampler_words;
  std::vector<std::string> spp_words;
  std::vector<std::string> seconds_words;
  std::string size = "64x64";
  PointChoice point_choice = PointChoice::Sobol;
  int seeds = 4;
  std::uint64_t seed = 0;
  int reference_spp = 4096;
  renderer::SamplerKind reference_sampler = renderer::SamplerKind::Product;
  renderer::RenderOptions render; ///< estimator and sampling options that all runs share
  CacheOptions cache;

  std::vector<renderer::SamplerKind> samplers; ///< the first is the base of equal times
  std::vector<int> spps;                       ///< rising
  std::vector<double> seconds;                 ///< rising; empty: the base's own times
  std::vector<renderer::Points> points;
};

/// Independent runs that the reference is averaged from.
inline constexpr int reference_runs = 8;

/// Declares all options.
void declare(tool::Tool& app, Plan& plan);

/// Completes the plan. @throws UsageError for what cannot be
void check(Plan& plan);

/// Units of work that one pair takes: samples per pixel of all runs, roughly.
double work_units(const Plan& plan);

/// A path's name without directories and without what follows its last dot.
std::string stem_of(const std::string& path);

} // namespace haarlight::bench
