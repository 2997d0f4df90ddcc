#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "geometry/shapes.h"
#include "scene/gltf_export.h"

/// Writes ball.glb, a sphere of marble of radius 0.1 m, into a folder.
inline std::filesystem::path write_ball(const std::filesystem::path& folder) {
  using namespace alabaster;
  TriangleMesh mesh = make_sphere(0.1, 24);
  mesh.materials.assign(mesh.triangle_count(), 0);
  ExportScene scene;
  scene.objects = {{"ball", &mesh}};
  ExportMaterial marble;
  marble.name = "marble";
  marble.base_colour = Rgb(0.8, 0.7, 0.6);
  scene.materials = {marble};
  const std::filesystem::path file = folder / "ball.glb";
  write_glb(file, scene);
  return file;
}

inline std::filesystem::path write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
  return file;
}

/// scene.json beside ball.glb, with defaults for a quick render.
inline std::filesystem::path write_ball_scene(const std::filesystem::path& folder) {
  write_ball(folder);
  return write_text(folder / "scene.json", R"({
    "version": 1, "model": "ball.glb",
    "environment": {"sky": {"ambient": 0.15, "key": 3, "exponent": 4, "direction": [-0.6, 0.62, 0.5]},
                    "visible": false},
    "materials": {"*": {"subsurface": true, "mean_free_path": 0.01}},
    "integrator": {"size": "24x16", "spp": 4}
  })");
}
