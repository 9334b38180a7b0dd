#include <support/output_size.h>

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace haarlight::tool {
namespace {

constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t pixel_bytes = 3 * sizeof(float);

/// The product, or the largest number if it exceeds that.
std::uint64_t times(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > most / b ? most : a * b;
}

std::uint64_t pixels_of(const wavelet::SetInfo& info) {
  const auto side = static_cast<std::uint64_t>(info.size);
  return side * side;
}

std::uint64_t maps_of(const wavelet::SetInfo& info) {
  return static_cast<std::uint64_t>(info.columns) * static_cast<std::uint64_t>(info.rows);
}

std::uint64_t threads() { return static_cast<std::uint64_t>(thread_count()); }

/// Space for a new file; unlimited where the system does not say.
std::uint64_t free_space(const std::string& path) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const auto space = std::filesystem::space(folder.empty() ? "." : folder, error);
  return error ? most : static_cast<std::uint64_t>(space.available);
}

void require(const std::string& path, std::uint64_t needed, std::uint64_t there, const char* of) {
  if (needed > there)
    throw_output_error(path, std::string("would take about ") + size_text(needed) + " of " + of +
                                 ", " + size_text(there) +
                                 " are available; smaller or fewer maps or pixels are needed, or "
                                 "--force to try");
}

} // namespace

void add_force(Tool& tool, bool& force) {
  tool.flag(force, "--force",
            "Start even if the output is estimated to exceed the available memory or disk space");
}

void require_room(const std::string& path, const OutputSize& size, bool force) {
  if (force)
    return;
  require(path, size.disk, free_space(path), "disk space");
  require(path, size.memory, available_memory(), "memory");
}

OutputSize exr_set_size(const wavelet::SetInfo& info) {
  const std::uint64_t map = times(pixels_of(info), pixel_bytes);
  return {times(map, threads() + 1), times(map, maps_of(info))};
}

OutputSize haar_set_size(const wavelet::SetInfo& info, std::uint64_t node_bytes) {
  // The map, its transform, what thresholding sorts, and what is left of it.
  constexpr std::uint64_t copies = 4;
  const std::uint64_t map = times(pixels_of(info), pixel_bytes);
  const std::uint64_t nodes = pixels_of(info) / 3;
  return {times(map, copies * std::min(threads(), maps_of(info))),
          times(times(nodes, node_bytes), maps_of(info)) / 100};
}

OutputSize film_size(int width, int height) {
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  constexpr std::uint64_t film = 9 * sizeof(float);
  return {times(pixels, 2 * film), times(pixels, film) / 2};
}

OutputSize transfer_size(int width, int height) {
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  constexpr std::uint64_t index_entry = 40;
  constexpr std::uint64_t empty_tree = 32;
  return {times(pixels, 2 * index_entry), times(pixels, index_entry + empty_tree)};
}

} // namespace haarlight::tool
