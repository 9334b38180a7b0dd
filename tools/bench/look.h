#pragma once
// How samplers look in figures and tables.

#include <html/look.h>

#include <renderer/samplers/sampler_kind.h>

#include <string>

namespace haarlight::bench {

/// The same in every figure; dashed if the sampler is biased.
html::Look look_of(renderer::SamplerKind kind);

/// A sampler's name beside its colour, with a mark if it is biased.
std::string sampler_html(const std::string& name);

} // namespace haarlight::bench
