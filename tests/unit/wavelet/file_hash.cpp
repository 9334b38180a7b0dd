#include "temporary_folder.h"

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <catch2/catch.hpp>

#include <fstream>

using namespace haarlight;

TEST_CASE("a file's hash is that of its bytes, however many they are") {
  const TemporaryFolder folder;
  for (const std::size_t size : {0U, 1U, 4096U, 1U << 18U, (1U << 18U) + 1U, 1000000U}) {
    const std::string path = folder.file("file");
    std::string text(size, 'x');
    for (std::size_t i = 0; i < size; ++i)
      text[i] = static_cast<char>(i * i % 251);
    std::ofstream(path, std::ios::binary) << text;
    CHECK(file_hash(path) == hash_text(InputFile(path).bytes()));
  }
  CHECK_THROWS_AS(file_hash(folder.file("missing")), Error);
}
