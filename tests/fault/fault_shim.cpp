// Preloaded into a program under test: the k-th call of one function fails.
//   FAULT_CALL   name of the function; pwrite and open stand for their 64-bit names too
//   FAULT_INDEX  k, from 1; all calls from the k-th on fail if it is negative
//   FAULT_ERROR  errno of the failure
//   FAULT_MARK   file that is made when a call is made to fail
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

std::atomic<long> calls{0};

/// Whether this call of `name` is one that must fail.
bool fails(const char* name) {
  const char* wanted = std::getenv("FAULT_CALL");
  if (wanted == nullptr || std::strcmp(wanted, name) != 0)
    return false;
  const long index = std::atol(std::getenv("FAULT_INDEX"));
  const long call = ++calls;
  if (index > 0 ? call != index : call < -index)
    return false;
  const long mark = ::syscall(SYS_openat, AT_FDCWD, std::getenv("FAULT_MARK"),
                              O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  if (mark >= 0)
    ::syscall(SYS_close, mark);
  errno = std::atoi(std::getenv("FAULT_ERROR"));
  return true;
}

template <class F>
F* next(const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

mode_t mode_of(int flags, va_list arguments) {
  const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  return creates ? va_arg(arguments, mode_t) : 0;
}

} // namespace

extern "C" {

ssize_t write(int file, const void* data, size_t size) {
  return fails("write") ? -1 : next<decltype(write)>("write")(file, data, size);
}

ssize_t pwrite(int file, const void* data, size_t size, off_t at) {
  return fails("pwrite") ? -1 : next<decltype(pwrite)>("pwrite")(file, data, size, at);
}

ssize_t pwrite64(int file, const void* data, size_t size, off64_t at) {
  return fails("pwrite") ? -1 : next<decltype(pwrite64)>("pwrite64")(file, data, size, at);
}

int fsync(int file) { return fails("fsync") ? -1 : next<decltype(fsync)>("fsync")(file); }

int rename(const char* from, const char* to) noexcept {
  return fails("rename") ? -1 : next<int(const char*, const char*)>("rename")(from, to);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  return fails("linkat") ? -1
                         : next<int(int, const char*, int, const char*, int)>("linkat")(
                               from_folder, from, to_folder, to, flags);
}

int ftruncate(int file, off_t size) noexcept {
  return fails("ftruncate") ? -1 : next<int(int, off_t)>("ftruncate")(file, size);
}

int ftruncate64(int file, off64_t size) noexcept {
  return fails("ftruncate") ? -1 : next<int(int, off64_t)>("ftruncate64")(file, size);
}

void* mmap(void* address, size_t size, int protection, int flags, int file, off_t at) noexcept {
  return fails("mmap") ? MAP_FAILED
                       : next<void*(void*, size_t, int, int, int, off_t)>("mmap")(
                             address, size, protection, flags, file, at);
}

void* mmap64(void* address, size_t size, int protection, int flags, int file, off64_t at) noexcept {
  return fails("mmap") ? MAP_FAILED
                       : next<void*(void*, size_t, int, int, int, off64_t)>("mmap64")(
                             address, size, protection, flags, file, at);
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return fails("open") ? -1 : next<int(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return fails("open") ? -1 : next<int(const char*, int, ...)>("open64")(path, flags, mode);
}

int mkostemp(char* name, int flags) {
  return fails("mkostemp") ? -1 : next<int(char*, int)>("mkostemp")(name, flags);
}

int mkostemp64(char* name, int flags) {
  return fails("mkostemp") ? -1 : next<int(char*, int)>("mkostemp64")(name, flags);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* argument) noexcept {
  if (fails("pthread_create"))
    return errno;
  return next<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create")(
      thread, attributes, start, argument);
}
}
