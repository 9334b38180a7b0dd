#pragma once
// The few pixels of a probe that sampling could miss or count twice.

#include <probe/probe.h>

namespace haarlight::probe {

/// What a pixel shows beyond its surroundings; to be spread by area instead of being sampled.
struct Peak {
  int x = 0;
  int y = 0;
  Rgb excess;
};

/// A probe taken apart: base + peaks = the probe.
struct SplitProbe {
  std::vector<float> base; ///< four floats for each pixel, row by row
  std::vector<Peak> peaks;
};

/// The base is nowhere brighter than three times the mean of the 24 pixels around: lights of one or
/// two pixels become peaks, wider ones stay, as do edges.
SplitProbe split_peaks(const Probe& probe);

} // namespace haarlight::probe
