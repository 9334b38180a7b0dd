#include "brdf_test_support.h"

#include <brdf/merl_file.h>

#include <wavelet/base/error.h>

#include <cstdint>
#include <cstring>
#include <limits>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;

namespace {

constexpr std::size_t file_size = 12 + 24 * 1458000;

std::string header(std::int32_t a, std::int32_t b, std::int32_t c) {
  const std::int32_t dims[3] = {a, b, c};
  std::string bytes(12, '\0');
  std::memcpy(bytes.data(), dims, 12);
  return bytes;
}

/// Reads bytes as a file and returns the error, which must be of kind Input and name the file.
Error error_of(const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = folder.file("broken.binary");
  write_bytes(path, bytes);
  try {
    read_merl(path);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::Input);
    CHECK(error.path() == path);
    return error;
  }
  FAIL("no error");
  throw 0;
}

std::string valid_bytes() { return header(90, 90, 180) + std::string(file_size - 12, '\0'); }

Error error_of_value(std::size_t index, double value) {
  std::string bytes = valid_bytes();
  std::memcpy(bytes.data() + 12 + 8 * index, &value, 8);
  return error_of(bytes);
}

} // namespace

TEST_CASE("MERL files round-trip exactly", "[merl]") {
  const TemporaryFolder folder;
  for (const int bins : {180, 360}) {
    const MerlTable table = random_table(1, 7, bins);
    const std::string path = folder.file("table.binary");
    write_merl(path, table);
    CHECK(std::filesystem::file_size(path) == 12 + 24 * table.plane_size());
    const MerlTable back = read_merl(path);
    CHECK(back.phi_d_bins == bins);
    CHECK(back.raw == table.raw);
  }
}

TEST_CASE("MERL bytes lie as the format says", "[merl]") {
  const TemporaryFolder folder;
  MerlTable table;
  table.raw[2 * table.plane_size() + table.cell(3, 4, 5)] = 42.5;
  write_merl(folder.file("a"), table);
  const std::string bytes = read_bytes(folder.file("a"));
  CHECK(bytes.substr(0, 12) == header(90, 90, 180));
  double value = 0;
  std::memcpy(&value, bytes.data() + 12 + 8 * (2 * 1458000 + 5 + 180 * (4 + 90 * 3)), 8);
  CHECK(value == 42.5);
}

TEST_CASE("wrong MERL dimensions are named one by one", "[merl]") {
  const std::string permuted = error_of(header(180, 90, 90)).what();
  CHECK(permuted.find("theta_h is 180, must be 90") != std::string::npos);
  CHECK(permuted.find("phi_d is 90, must be 180") != std::string::npos);
  CHECK(permuted.find("theta_d") == std::string::npos);
  CHECK(std::string(error_of(header(90, 91, 180)).what()).find("theta_d is 91") !=
        std::string::npos);
  // Sizes whose product overflows 32 bits, negative ones, and text.
  CHECK(error_of(header(90, 90, std::numeric_limits<std::int32_t>::max())).offset() == 0);
  CHECK(error_of(header(-90, -90, 180)).offset() == 0);
  CHECK(error_of("just a line of text, no reflectance\n").offset() == 0);
}

TEST_CASE("damaged MERL headers are refused before the values are read", "[merl]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("broken.binary");
  const auto refused = [&](const std::string& first, std::size_t size) {
    write_bytes(path, first);
    std::filesystem::resize_file(path, size); // a sparse file of zeros
    CHECK_THROWS_AS(read_merl(path), Error);
  };
  const std::string right = header(90, 90, 180);
  for (std::size_t bit = 0; bit < 96; ++bit) {
    std::string damaged = right;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    refused(damaged, file_size);
  }
  for (const std::int32_t extreme : {-1, 0, 1 << 30, std::numeric_limits<std::int32_t>::max(),
                                     std::numeric_limits<std::int32_t>::min()}) {
    refused(header(extreme, 90, 180), file_size);
    refused(header(90, extreme, 180), file_size);
    refused(header(90, 90, extreme), file_size);
    refused(header(extreme, extreme, extreme), 12);
  }
  for (std::size_t size = 0; size < file_size; size += file_size / 50)
    refused(right.substr(0, size), size);
}

TEST_CASE("MERL files of the wrong size are refused where they end", "[merl]") {
  CHECK(error_of("").offset() == 0);
  CHECK(error_of("abc").offset() == 3);
  CHECK(error_of(header(90, 90, 180)).offset() == 12);
  CHECK(error_of(valid_bytes().substr(0, 1000001)).offset() == 1000001);
  CHECK(error_of(valid_bytes() + "x").offset() == file_size);
  CHECK(error_of(header(90, 90, 360) + valid_bytes().substr(12)).offset() == file_size);
}

TEST_CASE("MERL values that are no numbers are refused with their place", "[merl]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(error_of_value(0, nan).offset() == 12);
  CHECK(error_of_value(1234567, infinity).offset() == 12 + 8 * 1234567);
  CHECK(error_of_value(3 * 1458000 - 1, -infinity).offset() == file_size - 8);
  CHECK(error_of_value(5, 1e300).offset() == 52);
}

TEST_CASE("a MERL file that is missing, a folder or unwritable is an error", "[merl]") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(read_merl(folder.file("absent")), Error);
  CHECK_THROWS_AS(read_merl(folder.file(".")), Error);
  try {
    write_merl(folder.file("no/such/folder.binary"), MerlTable());
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::Output);
  }
  CHECK(std::filesystem::is_empty(folder.file(".")));
}
