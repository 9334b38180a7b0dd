// The transform in tiles and vectors against plain lifting, bit by bit.

#include <wavelet/transform/transform.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

template <class T>
void lift(T& a, T& b) {
  const T difference = T(0.5) * (a - b);
  a -= difference;
  b = difference;
}

template <class T>
void unlift(T& a, T& b) {
  const T sum = a + b;
  b = a - b;
  a = sum;
}

/// Calls visit(a, b, c, d), a b over c d, for every 2 × 2 square of samples `stride` pixels apart.
template <class T, class Visit>
void for_each_square(T* image, int size, int channels, int stride, Visit visit) {
  const auto reach = static_cast<std::size_t>(stride) * static_cast<std::size_t>(channels);
  const std::size_t drop = reach * static_cast<std::size_t>(size);
  for (int y = 0; y < size; y += 2 * stride) {
    T* a = image + static_cast<std::size_t>(y) / static_cast<std::size_t>(stride) * drop;
    for (int x = 0; x < size; x += 2 * stride, a += 2 * reach)
      for (int c = 0; c < channels; ++c)
        visit(a[c], a[c + reach], a[c + drop], a[c + drop + reach]);
  }
}

template <class T>
void plain_forward(T* image, int size, int channels) {
  for (int stride = 1; stride < size; stride *= 2)
    for_each_square(image, size, channels, stride, [](T& a, T& b, T& c, T& d) {
      lift(a, b);
      lift(c, d);
      lift(a, c);
      lift(b, d);
    });
}

template <class T>
void plain_inverse(T* image, int size, int channels) {
  for (int stride = size / 2; stride >= 1; stride /= 2)
    for_each_square(image, size, channels, stride, [](T& a, T& b, T& c, T& d) {
      unlift(a, c);
      unlift(b, d);
      unlift(a, b);
      unlift(c, d);
    });
}

constexpr std::uint64_t guard = 0x7ff4dead7fb4beef; ///< not-a-numbers

/// Random elements of all magnitudes and both signs, and guards on either side.
template <class T>
class Guarded {
public:
  explicit Guarded(std::size_t count) : m_all(count + 2 * margin) {
    std::mt19937 generator(static_cast<unsigned>(count));
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::uniform_int_distribution<int> exponent(-30, 30);
    for (T& value : m_all)
      value = static_cast<T>(std::ldexp(uniform(generator), exponent(generator)));
    for (std::size_t i = 0; i < margin; ++i)
      m_all[i] = m_all[m_all.size() - 1 - i] = guard_value();
  }
  T* data() { return m_all.data() + margin; }
  bool operator==(const Guarded& other) const {
    return std::memcmp(m_all.data(), other.m_all.data(), m_all.size() * sizeof(T)) == 0;
  }

private:
  static constexpr std::size_t margin = 17;
  static T guard_value() {
    T value;
    std::memcpy(&value, &guard, sizeof value);
    return value;
  }
  std::vector<T> m_all;
};

template <class T>
bool forward_as_plain(int size, int channels) {
  Guarded<T> plain(static_cast<std::size_t>(size) * size * channels);
  Guarded<T> ours = plain;
  plain_forward(plain.data(), size, channels);
  haar_forward(ours.data(), size, channels);
  return ours == plain;
}

template <class T>
bool inverse_as_plain(int size, int channels) {
  Guarded<T> plain(static_cast<std::size_t>(size) * size * channels);
  Guarded<T> ours = plain;
  plain_inverse(plain.data(), size, channels);
  haar_inverse(ours.data(), size, channels);
  return ours == plain;
}

template <class T>
void check(int size, int channels) {
  INFO("size " << size << ", channels " << channels << ", bytes " << sizeof(T));
  CHECK(forward_as_plain<T>(size, channels));
  CHECK(inverse_as_plain<T>(size, channels));
}

} // namespace

TEST_CASE("the transform has the bits of plain lifting, at every size and number of channels") {
  for (int size = 1; size <= 128; size *= 2)
    for (const int channels : {1, 2, 3, 4, 5, 7, 8, 16, 23}) {
      check<float>(size, channels);
      check<double>(size, channels);
    }
}

TEST_CASE("the transform has the bits of plain lifting in images of many tiles") {
  for (const int size : {256, 1024})
    for (const int channels : {1, 3}) {
      check<float>(size, channels);
      check<double>(size, channels);
    }
  check<float>(2048, 1);
}

TEST_CASE("the largest image has the bits of plain lifting", "[.large]") { check<float>(8192, 1); }
