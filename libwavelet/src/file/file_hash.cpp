#include <wavelet/file/file_hash.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <xxhash.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

namespace haarlight {
namespace {

constexpr std::size_t piece = std::size_t{1} << 18U;

[[noreturn]] void refuse(const std::string& path) {
  throw_input_error(path, std::string("cannot be read: ") + std::strerror(errno));
}

/// As hash_text() writes it.
std::string digits_of(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

} // namespace

std::string file_hash(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(openable_path(path).c_str(), "rb"), std::fclose);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  if (!file)
    refuse(path);
  XXH3_64bits_reset(state.get());
  std::vector<char> bytes(piece);
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file.get()))
    XXH3_64bits_update(state.get(), bytes.data(), count);
  if (std::ferror(file.get()) != 0)
    refuse(path);
  return digits_of(XXH3_64bits_digest(state.get()));
}

} // namespace haarlight
