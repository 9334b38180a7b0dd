#pragma once
// Compiles a function for several instruction sets, the widest one chosen when the program starts.
// All round alike: nothing is contracted to fused operations (-ffp-contract=off) and loops so
// marked hold no sums across their index.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define HAARLIGHT_CPU_CLONES                                                                       \
  __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4"), flatten))
#else
#define HAARLIGHT_CPU_CLONES
#endif
