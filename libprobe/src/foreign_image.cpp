#include "foreign_image.h"

#include <wavelet/error.h>
#include <wavelet/input_file.h>

#include <climits>

#include <dlfcn.h>
#include <unistd.h>

namespace haarlight::probe {
namespace {

constexpr const char* module_name = "haarlight_images.so";

/// Folder of the running program, with a slash at its end.
std::string program_folder() {
  char path[PATH_MAX];
  const ssize_t length = ::readlink("/proc/self/exe", path, sizeof path);
  const std::string name(path, length > 0 ? static_cast<std::size_t>(length) : 0);
  return name.substr(0, name.find_last_of('/') + 1);
}

/// Beside our own programs first, in the build tree and installed alike; then where the program's
/// run path leads, which is how programs of other projects find it.
ReadForeign load_module() {
  void* module = ::dlopen((program_folder() + HAARLIGHT_MODULE_FOLDER + module_name).c_str(),
                          RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr)
    module = ::dlopen(module_name, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr)
    return nullptr;
  return reinterpret_cast<ReadForeign>(::dlsym(module, read_foreign_name));
}

} // namespace

ForeignImage read_foreign_image(const std::string& path) {
  static const ReadForeign read = load_module();
  if (read == nullptr)
    throw_input_error(path, std::string("is no Radiance RGBE picture, and ") + module_name +
                                ", which reads other formats, cannot be loaded");
  ForeignImage result;
  read(openable_path(path), result);
  if (!result.error.empty())
    throw_input_error(path, result.error);
  return result;
}

} // namespace haarlight::probe
