#pragma once

#include <string>
#include <vector>

#include "integrators/planar_scene.h"

namespace alabaster {

/// A scene of the studies, by the name that scripts, charts and people share.
struct StudyScene {
  std::string id;
  std::string title;  // for people
  std::string set;    // "planar" and "mesh"; "planar-more" are flat scenes outside the standard set
};

const std::vector<StudyScene>& study_scenes();

/// Ids and names of sets, in any mixture, as a list of ids without repetition, in the order of
/// study_scenes(). Throws InputError naming the unknown one and the known ones.
std::vector<std::string> expand_scene_ids(const std::vector<std::string>& ids_and_sets);

/// The flat scenes of [EK17] figures 4 and 5: 400 x 400 texels over 10 x 10 m with a mean free path of 1 m
/// (colour_bleeding_xF: of 1/F m), lit within radius 1 m of the centre (colour_bleeding: 4 m), seen straight
/// down over 10 x 10 m in `pixels` x `pixels`. Throws InputError when no flat scene has that id.
PlanarScene make_planar_study_scene(const std::string& id, int pixels = 100);

}  // namespace alabaster
