#pragma once
// From files to images and probes.

#include <probe/probe.h>

#include <wavelet/base/image.h>
#include <wavelet/file/provenance.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::probe {

/// An image and its origin, for the provenance of outputs.
struct LoadedImage {
  Image image;
  std::string name;               ///< base name of the file
  std::string hash;               ///< of its bytes, 16 hexadecimal digits
  std::vector<std::string> notes; ///< conversions on reading, a sentence each
};

/// Selects one of several images in a file; empty texts select the default.
struct ImageChoice {
  std::string layer; ///< OpenEXR: the part of the channel names before the last dot
  std::string part;  ///< OpenEXR: name or number of a part; TIFF: number of a page; from 0
};

/// Reads Radiance RGBE, OpenEXR, PFM, TIFF, PNG and JPEG, recognised by content. Grey becomes RGB;
/// values encoded for display are made linear, other primaries are converted to Rec. 709,
/// orientation tags are obeyed; negative values are set to 0. Notes state the conversions. OpenEXR:
/// the data window is placed in the display window. Formats other than RGBE and PFM are decoded by
/// a separate program with limits of memory and time.
/// @throws Error(Input) if the file is missing, of no accepted format, damaged, truncated, too
/// large,
///         ambiguous (several layers or parts hold colours and none is chosen), or holds a NaN or
///         an infinity, whose pixel is named; std::runtime_error if the program cannot be started
LoadedImage read_image(const std::string& path, const ImageChoice& choice = {});

/// The checks of read_image(): rejects NaN and infinities, clamps negative values to 0.
/// @return values that were negative
/// @throws Error(Input)
std::size_t clean_pixels(Image& image, const std::string& path);

/// The mapping of an image, and a sentence stating the reason.
struct DetectedMapping {
  Mapping mapping = Mapping::Angular;
  std::string reason;
};

/// Decides by aspect ratio, and by content where that is ambiguous: 2:1 is latlong; a square
/// picture is octahedral if its corners are not empty and its edges are folded onto themselves,
/// else angular. A mirror ball cannot be distinguished from an angular map and is never chosen.
/// @throws Error(Input) if the aspect is neither 2:1 nor 1:1
DetectedMapping detect_mapping(const Image& image, const std::string& path = {});

/// A probe and its origin.
struct LoadedProbe {
  Probe probe;
  std::string mapping_reason;     ///< a sentence: the mapping and the reason
  std::vector<std::string> notes; ///< conversions on reading
  Provenance source;              ///< source (base name), source_hash, mapping
};

/// @param mapping nothing = detect_mapping
/// @throws Error(Input) as read_image, detect_mapping and Probe do
LoadedProbe read_probe(const std::string& path, std::optional<Mapping> mapping = std::nullopt,
                       Lookup lookup = Lookup::Nearest, const ImageChoice& choice = {});

} // namespace haarlight::probe
