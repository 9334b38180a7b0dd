#pragma once
// The arithmetic of BrdfMaps for many samples at once.

#include <brdf/measured_brdf.h>

#include <cstdint>

namespace haarlight::brdf {

/// Samples of one map; place_samples() fills the second half from the first.
struct SampleBatch {
  float middle_wo[3] = {0, 0, 1}; ///< ω_o for the middle normal of the cell
  int count = 0;
  float u[batch_capacity], v[batch_capacity]; ///< square coordinates of ω
  float spacing[batch_capacity];              ///< width of what a sample stands for, radians
  float normal[3][batch_capacity];

  float cosine[batch_capacity];     ///< n·ω
  float resolution[batch_capacity]; ///< over one: the sample is too coarse for the table there
  HalfDifferenceBatch angles;       ///< of ω and ω_o, the mirror image of z about n
};

void place_samples(SampleBatch& batch);

} // namespace haarlight::brdf
