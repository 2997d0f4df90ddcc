#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "integrators/planar_scene.h"
#include "optics/profile_table.h"

namespace alabaster {

/// A flat scene of one's own, as docs/planar_laboratory.md describes it: any picture as albedo or as
/// reflectance, its width in mean free paths, light and view. `resolution` is the view's longer side in
/// pixels unless the file says otherwise. Throws InputError with file, place and mend.
PlanarScene load_planar_scene(const std::filesystem::path& path, int resolution);

/// Flat scenes by id or set (study/scene_sets.h) or by file (NAME.json), each optionally seen otherwise:
/// ID@45 and ID@75 look from that many degrees off the normal, towards +x; ID@radiosity sums over all
/// directions.
std::vector<PlanarScene> planar_scenes(const std::vector<std::string>& names, int resolution);

/// The homogeneous basis of a scene's medium. Throws InputError where there is none.
const ProfileTable& profile_for(const PlanarScene& scene);

}  // namespace alabaster
