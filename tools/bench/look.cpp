#include <bench/look.h>

#include <html/text.h>

namespace haarlight::bench {

html::Look look_of(renderer::SamplerKind kind) {
  const auto index = static_cast<std::size_t>(kind);
  return {html::series_colour(index), static_cast<int>(index) % html::marker_count,
          renderer::traits(kind).bias == renderer::Bias::Biased};
}

std::string sampler_html(const std::string& name) {
  const auto kind = renderer::sampler_from_name(name);
  if (!kind)
    return html::escaped(name);
  const bool biased = renderer::traits(*kind).bias == renderer::Bias::Biased;
  return html::swatch_svg(look_of(*kind)) + html::escaped(name) +
         (biased ? " <span class=\"tag\">biased</span>" : "");
}

} // namespace haarlight::bench
