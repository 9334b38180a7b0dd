#include <brdf/merl_file.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>

namespace haarlight::brdf {
namespace {

static_assert(std::endian::native == std::endian::little,
              "MERL files are read as they lie in memory");

constexpr std::size_t header_size = 12;
constexpr double largest_value = 1e30;

struct Dimensions {
  std::int32_t theta_h;
  std::int32_t theta_d;
  std::int32_t phi_d;
};

Dimensions read_dimensions(const InputFile& file) {
  const auto bytes = file.beginning(header_size);
  if (bytes.size() < header_size)
    throw_input_error(file.path(), "file ends inside the 12-byte header of a MERL file",
                      bytes.size());
  Dimensions dims{};
  std::memcpy(&dims, bytes.data(), header_size);
  return dims;
}

/// Appends `name is N, must be M` for a wrong dimension.
void append_mismatch(std::string& text, bool good, const char* name, std::int32_t found,
                     const char* right) {
  if (!good)
    text += std::string(text.empty() ? "" : ", ") + name + " is " + std::to_string(found) +
            ", must be " + right;
}

void check_dimensions(const InputFile& file, const Dimensions& dims) {
  std::string text;
  append_mismatch(text, dims.theta_h == merl_theta_h_bins, "theta_h", dims.theta_h, "90");
  append_mismatch(text, dims.theta_d == merl_theta_d_bins, "theta_d", dims.theta_d, "90");
  append_mismatch(text, dims.phi_d == merl_phi_d_bins || dims.phi_d == merl_unfolded_phi_d_bins,
                  "phi_d", dims.phi_d, "180 (or 360)");
  if (!text.empty())
    throw_input_error(file.path(), "no MERL file of 90 x 90 x 180 bins: " + text, 0);
}

void check_size(const InputFile& file, const Dimensions& dims) {
  const std::uint64_t cells =
      std::uint64_t{merl_theta_h_bins} * merl_theta_d_bins * static_cast<std::uint64_t>(dims.phi_d);
  const std::uint64_t wanted = header_size + 3 * sizeof(double) * cells;
  const std::uint64_t found = file.size();
  if (found != wanted)
    throw_input_error(file.path(),
                      (found < wanted ? "file ends early: has " : "data after the end: has ") +
                          std::to_string(found) + " bytes, must have " + std::to_string(wanted),
                      std::min(found, wanted));
}

/// Also rejects values beyond the range of float.
void check_values(const InputFile& file, std::span<const double> values) {
  const auto bad = std::find_if(values.begin(), values.end(),
                                [](double v) { return !(std::abs(v) <= largest_value); });
  if (bad == values.end())
    return;
  const auto index = static_cast<std::uint64_t>(bad - values.begin());
  const char* fault = std::isnan(*bad) ? "NaN" : std::isinf(*bad) ? "infinite" : "beyond 1e30";
  throw_input_error(file.path(),
                    std::string("value is ") + fault + ", must be a finite reflectance",
                    header_size + sizeof(double) * index);
}

} // namespace

MerlTable read_merl(const std::string& path) {
  const InputFile file(path);
  const Dimensions dims = read_dimensions(file);
  check_dimensions(file, dims);
  check_size(file, dims);
  MerlTable table(dims.phi_d);
  std::memcpy(table.raw.data(), file.bytes().data() + header_size,
              table.raw.size() * sizeof(double));
  check_values(file, table.raw);
  return table;
}

void write_merl(const std::string& path, const MerlTable& table) {
  assert(table.raw.size() == 3 * table.plane_size());
  const Dimensions dims{merl_theta_h_bins, merl_theta_d_bins, table.phi_d_bins};
  OutputFile file(path);
  file.write(&dims, header_size);
  file.write(table.raw.data(), table.raw.size() * sizeof(double));
  file.commit();
}

} // namespace haarlight::brdf
