#pragma once
// Estimates of memory and disk space: outputs that do not fit are refused before any work is done.

#include <support/tool.h>

#include <wavelet/tree/map_set.h>

#include <cstdint>
#include <string>

namespace haarlight::tool {

/// Estimated size of an output in bytes.
struct OutputSize {
  std::uint64_t memory = 0;
  std::uint64_t disk = 0;
};

/// Declares --force.
void add_force(Tool& tool, bool& force);

/// @throws Error(Output), with the sizes, if the estimate exceeds the memory available or the free
///         space of the output's file system; not if `force` is set
void require_room(const std::string& path, const OutputSize& size, bool force);

/// An EXR with the pixels of all maps, uncompressed.
OutputSize exr_set_size(const wavelet::SetInfo& info);

/// A .haar file. Thresholded trees of measured BRDFs and probes keep 1 to 10 % of all coefficients;
/// the estimate is 1 %. @param node_bytes of a node with its link
OutputSize haar_set_size(const wavelet::SetInfo& info, std::uint64_t node_bytes);

/// A rendered film: nine floats a pixel, held twice while the EXR is written.
OutputSize film_size(int width, int height);

/// A transfer: at least a tree of no nodes and an index entry for each pixel.
OutputSize transfer_size(int width, int height);

} // namespace haarlight::tool
