#pragma once
// What programs that make maps report of them.

#include <support/report.h>

#include <wavelet/transform/compress.h>
#include <wavelet/tree/map_set.h>

namespace haarlight::tool {

/// The set's size.
void describe_set(const wavelet::SetInfo& info, Report& report);

/// A section "conservation". @param tolerance of the mean error
void describe(const wavelet::Conservation& conservation, double tolerance, Report& report);

/// A section "compression": the options, and what they did.
void describe(const wavelet::CompressReport& result, const wavelet::CompressOptions& options,
              Report& report);

} // namespace haarlight::tool
