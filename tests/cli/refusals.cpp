// Preloaded into a program, makes system calls fail as they do on a system without the resource:
// REFUSE=threads  no thread can be started
// REFUSE=tmpfile  the file system has no files without a name (O_TMPFILE)
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>

namespace {

bool refused(const char* what) {
  const char* list = std::getenv("REFUSE");
  return list != nullptr && std::strstr(list, what) != nullptr;
}

template <class F>
F next(const char* name) {
  return reinterpret_cast<F>(::dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*start)(void*), void* argument) {
  if (refused("threads"))
    return EAGAIN;
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  return next<Create>("pthread_create")(thread, attributes, start, argument);
}

extern "C" int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const unsigned mode = va_arg(arguments, unsigned);
  va_end(arguments);
  if ((flags & O_TMPFILE) == O_TMPFILE && refused("tmpfile")) {
    errno = EOPNOTSUPP;
    return -1;
  }
  return next<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}
