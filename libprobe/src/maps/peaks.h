#pragma once
// The few pixels of a probe that sampling could miss or count twice.

#include <probe/probe.h>

#include <vector>

namespace haarlight::probe {

/// A pixel of a probe's picture.
struct PixelPlace {
  int x = 0;
  int y = 0;
};

/// The pixels brighter than `contrast` times the mean of the 24 around them, row by row: lights of
/// few pixels and the corners of wider ones. At 3 these are lights of up to 2 × 2 pixels, at 2 of
/// up to 3 × 3.
std::vector<PixelPlace> find_peaks(const Probe& probe, double contrast = 3);

/// A power of two by which the probe's radiances are divided so that sums of samples stay finite; 1
/// for all but extreme ones.
float radiance_unit(const Probe& probe);

} // namespace haarlight::probe
