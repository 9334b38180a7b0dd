// MERL files. A whole one has 35 MB, so an input is a description of a file: its header, a
// difference from the right file size, and values at some offsets of a file that is zero elsewhere.
#include "fuzz_target.h"

#include <brdf/merl_file.h>

#include <xxhash.h>

#include <cstring>

using namespace haarlight;

namespace {

constexpr std::size_t header_bytes = 12;
constexpr std::size_t patch_bytes = 12; ///< a 32-bit index of a value, and the value
/// One in this many of the inputs whose header is right becomes a file of the right size, which
/// takes 100 times as long to read as any other.
constexpr std::uint64_t whole_file_interval = 1024;

/// Bytes of the file that a header asks for; 0 if the header is one to refuse.
std::uint64_t whole_size(std::span<const std::byte> header) {
  std::int32_t bins[3] = {};
  std::memcpy(bins, header.data(), header_bytes);
  const bool right =
      bins[0] == brdf::merl_theta_h_bins && bins[1] == brdf::merl_theta_d_bins &&
      (bins[2] == brdf::merl_phi_d_bins || bins[2] == brdf::merl_unfolded_phi_d_bins);
  return right ? header_bytes + std::uint64_t{24} * 90 * 90 * static_cast<std::uint64_t>(bins[2])
               : 0;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzzing::MemoryFile file;
  const auto bytes = fuzzing::bytes_of(data, size);
  const std::uint64_t whole = size > header_bytes ? whole_size(bytes) : 0;
  if (whole == 0 || XXH3_64bits(data, size) % whole_file_interval != 0) {
    file.assign(bytes);
  } else {
    file.clear(whole + (data[header_bytes] % 4 == 3 ? data[header_bytes] : 0));
    file.put(0, bytes.first(header_bytes));
    for (std::size_t at = header_bytes + 1; at + patch_bytes <= size; at += patch_bytes) {
      std::uint32_t index = 0;
      std::memcpy(&index, data + at, 4);
      file.put(header_bytes + 8 * (index % ((whole - header_bytes) / 8)), bytes.subspan(at + 4, 8));
    }
  }
  fuzzing::read_or_refuse([&] { brdf::read_merl(file.path()); });
  return 0;
}
