#include <span>

#include "optics/profile_store.h"
#include "optics/shape_families.h"
#include "optics/tabulated_profile.h"

// ALABASTER_BASELINE_TABLE and ALABASTER_BASELINE_SHAPES are paths of files in assets/ (CMakeLists.txt).
#define ALABASTER_EMBED(name, path) \
  asm(".section .rodata\n"          \
      ".balign 16\n"                \
      "alabaster_" name             \
      "_begin:\n"                   \
      ".incbin \"" path             \
      "\"\n"                        \
      "alabaster_" name             \
      "_end:\n"                     \
      ".byte 0\n"                   \
      ".previous\n")
ALABASTER_EMBED("baseline", ALABASTER_BASELINE_TABLE);
ALABASTER_EMBED("shapes", ALABASTER_BASELINE_SHAPES);

extern "C" const char alabaster_baseline_begin[];
extern "C" const char alabaster_baseline_end[];
extern "C" const char alabaster_shapes_begin[];
extern "C" const char alabaster_shapes_end[];

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

const ShapeTable& baseline_shape_table() {
  static const ShapeTable table = decode_shape_table(
      std::span<const char>(alabaster_shapes_begin, alabaster_shapes_end), "the built-in table of shapes");
  return table;
}

const ShapeFamilies& baseline_shapes() {
  static const ShapeFamilies shapes(baseline_shape_table());
  return shapes;
}

}  // namespace alabaster
