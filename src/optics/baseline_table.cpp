#include <span>

#include "optics/profile_table.h"
#include "optics/tabulated_profile.h"

// ALABASTER_BASELINE_TABLE is the path of assets/profile_g0.3_eta1.5.table (CMakeLists.txt).
asm(".section .rodata\n"
    ".balign 16\n"
    "alabaster_baseline_begin:\n"
    ".incbin \"" ALABASTER_BASELINE_TABLE
    "\"\n"
    "alabaster_baseline_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" const char alabaster_baseline_begin[];
extern "C" const char alabaster_baseline_end[];

namespace alabaster {

const ProfileTable& baseline_profile() {
  static const TabulatedProfile table(decode_table(
      std::span<const char>(alabaster_baseline_begin, alabaster_baseline_end), "the built-in table"));
  return table;
}

}  // namespace alabaster
