#include <span>

#include "optics/profile_store.h"
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

const TableData& baseline_table() {
  static const TableData table = decode_table(
      std::span<const char>(alabaster_baseline_begin, alabaster_baseline_end), "the built-in table");
  return table;
}

const ProfileTable& baseline_profile() {
  static const TabulatedProfile profile(baseline_table());
  return profile;
}

}  // namespace alabaster
