# What Debian 12 supplies. Only Eigen shows in public headers; the rest stays private to one target each.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenEXR 3.1 REQUIRED)
find_package(PNG REQUIRED)
find_package(Threads REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)

# Debian 12's CMake package of OpenImageIO names programs and directories that need not be installed;
# its pkg-config file does not.
pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)
