#include <probe/read_probe.h>

namespace haarlight::probe {

LoadedProbe read_probe(const std::string& path, std::optional<Mapping> mapping, Lookup lookup,
                       const ImageChoice& choice) {
  LoadedImage loaded = read_image(path, choice);
  const DetectedMapping taken =
      mapping
          ? DetectedMapping{*mapping, "mapping " + mapping_name(*mapping) + ", as was asked for"}
          : detect_mapping(loaded.image, path);
  LoadedProbe result{
      Probe(loaded.image, taken.mapping, lookup, path), taken.reason, std::move(loaded.notes), {}};
  result.source.set("source", loaded.name);
  result.source.set("source_hash", loaded.hash);
  result.source.set("mapping", mapping_name(taken.mapping));
  return result;
}

} // namespace haarlight::probe
