# How everything is compiled: C++20, Release unless said otherwise, the same bytes on every CPU.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
include(GNUInstallDirs)

option(HAARLIGHT_WERROR "Treat warnings as errors" OFF)
option(HAARLIGHT_BUILD_TOOLS "Build the programs, not the libraries alone" ON)
set(HAARLIGHT_SANITIZE "" CACHE STRING "Sanitizers: address;undefined or thread")

add_library(haarlight_settings INTERFACE)
# No fused multiply-add behind our back: results must not depend on the CPU.
target_compile_options(haarlight_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off -fno-math-errno
  $<$<BOOL:${HAARLIGHT_WERROR}>:-Werror>)
if(HAARLIGHT_SANITIZE)
  list(JOIN HAARLIGHT_SANITIZE "," sanitizers)
  target_compile_options(haarlight_settings INTERFACE -fsanitize=${sanitizers} -fno-omit-frame-pointer)
  target_link_options(haarlight_settings INTERFACE -fsanitize=${sanitizers})
endif()

# Eigen and the standard containers are parsed once instead of in every source: a third of a cold build. Executables
# are compiled with -fPIE, libraries with -fPIC, and a precompiled header serves one of the two.
option(HAARLIGHT_PRECOMPILE "Precompile the headers that nearly every source includes" ON)
set(HAARLIGHT_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <functional> <memory>
    <optional> <span> <string> <vector>)

# Sources of a library are compiled in batches: the other half of a cold build. Names in unnamed namespaces are therefore
# unique within a library.
set(HAARLIGHT_UNITY_BATCH 8 CACHE STRING "Sources compiled as one; 1 = each alone, 0 = all of a target")
