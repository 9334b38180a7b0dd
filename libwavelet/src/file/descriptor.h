#pragma once
// File descriptors that close themselves.

#include <unistd.h>

namespace haarlight {

struct Descriptor {
  int value;
  explicit Descriptor(int descriptor) : value(descriptor) {}
  ~Descriptor() { close(); }
  void close() {
    if (value >= 0)
      ::close(value);
    value = -1;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

} // namespace haarlight
