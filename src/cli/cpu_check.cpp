// Compiled for the oldest x86-64 and run before any other initialiser: the rest of the program may be
// compiled for AVX2, and a CPU without it should get a sentence, not SIGILL.

#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace {

[[gnu::constructor(101)]] void check_cpu() {
#ifdef ALABASTER_NEEDS_AVX2
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return;
  const char* text =
      "alabaster: this build needs a CPU with AVX2 (x86-64-v3); build for your own machine with "
      "cmake --preset release -DCMAKE_CXX_FLAGS=-march=native\n";
  if (write(STDERR_FILENO, text, std::strlen(text)) < 0) std::_Exit(3);
  std::_Exit(2);
#endif
}

}  // namespace
