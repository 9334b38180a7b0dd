#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>

#include <catch2/catch.hpp>

#include <atomic>
#include <stdexcept>
#include <vector>

using namespace haarlight;

TEST_CASE("Every index is visited once, in nested loops as well", "[parallel]") {
  for (const std::size_t count : {0U, 1U, 7U, 1000U}) {
    std::vector<std::atomic<int>> visits(count * 16);
    parallel_for(count, [&](std::size_t i) {
      parallel_for(16, [&](std::size_t j) { ++visits[16 * i + j]; });
    });
    for (const auto& visit : visits)
      REQUIRE(visit == 1);
  }
}

TEST_CASE("Ranges hold the grain at least", "[parallel]") {
  std::atomic<std::size_t> sum = 0;
  parallel_ranges(1003, 10, [&](std::size_t begin, std::size_t end) {
    if (end - begin < 10)
      throw std::logic_error("a short range");
    sum += end - begin;
  });
  CHECK(sum == 1003);
}

TEST_CASE("An exception of any thread stops the loop and is rethrown", "[parallel]") {
  std::atomic<int> calls = 0;
  CHECK_THROWS_AS(parallel_for(1000000,
                               [&](std::size_t) {
                                 ++calls;
                                 throw std::runtime_error("stop");
                               }),
                  std::runtime_error);
  CHECK(calls <= thread_count());
}

TEST_CASE("Memory that ends names the innermost purpose", "[memory]") {
  const auto nested = [] {
    with_memory_for("the outer", 0, [] {
      with_memory_for("the map of 8192 x 8192 pixels", std::uint64_t{512} << 20U,
                      [] { throw std::bad_alloc(); });
    });
  };
  CHECK_THROWS_WITH(nested(), "out of memory: 512 MiB for the map of 8192 x 8192 pixels");
  CHECK_THROWS_AS(parallel_for(100, [&](std::size_t) { nested(); }), OutOfMemory);
}
