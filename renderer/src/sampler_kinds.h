#pragma once
// The samplers behind make_sampler(), one source file each.

#include <renderer/sampler.h>

namespace haarlight::renderer {

std::unique_ptr<Sampler> make_light_sampler(const Light& light);
std::unique_ptr<Sampler> make_brdf_sampler();
std::unique_ptr<Sampler> make_mis_sampler(const Light& light);
std::unique_ptr<Sampler> make_product_sampler(const Light& light,
                                              const wavelet::AdaptiveOptions& options);
std::unique_ptr<Sampler> make_table_sampler(const Light& light);

} // namespace haarlight::renderer
