#include "geometry/mesh_builder.h"

#include <cmath>
#include <cstring>

namespace alabaster {

Vec2 circle_point(double k, int n) {
  const double turn = std::fmod(k, n) / n;
  // The axes exactly, so that shapes touch their bounding boxes.
  if (turn == 0) return {1, 0};
  if (turn == 0.25) return {0, 1};
  if (turn == 0.5) return {-1, 0};
  if (turn == 0.75) return {0, -1};
  return {std::cos(2 * pi * turn), std::sin(2 * pi * turn)};
}

uint32_t MeshBuilder::add_position(const Vec3& p) {
  std::array<uint64_t, 3> key;
  for (int k = 0; k < 3; ++k) {
    const double coordinate = p[k] + 0.0;  // turns -0 into 0
    std::memcpy(&key[static_cast<std::size_t>(k)], &coordinate, sizeof coordinate);
  }
  const auto [entry, fresh] = position_index_.try_emplace(key, static_cast<uint32_t>(mesh_.positions.size()));
  if (fresh) mesh_.positions.push_back(p);
  return entry->second;
}

uint32_t MeshBuilder::add_attribute(const Vertex& vertex) {
  if (mesh_.uv_sets.empty()) mesh_.uv_sets.emplace_back();
  mesh_.normals.emplace_back(glm::normalize(vertex.normal));
  mesh_.uv_sets[0].emplace_back(vertex.uv);
  return static_cast<uint32_t>(mesh_.normals.size() - 1);
}

void MeshBuilder::add_triangle(const GridVertex& a, const GridVertex& b, const GridVertex& c) {
  mesh_.corners.push_back({a.position, b.position, c.position});
  mesh_.attributes.push_back({a.attribute, b.attribute, c.attribute});
  mesh_.materials.push_back(material_);
}

void MeshBuilder::add_quad(const std::array<GridVertex, 4>& corners, const PatchFunction& vertex, double i,
                           double j) {
  const auto& [top_left, bottom_left, bottom_right, top_right] = corners;
  if (top_left.position == top_right.position) {
    const GridVertex apex{top_left.position, add_attribute(vertex(i + 0.5, j))};
    add_triangle(apex, bottom_left, bottom_right);
  } else if (bottom_left.position == bottom_right.position) {
    const GridVertex apex{bottom_left.position, add_attribute(vertex(i + 0.5, j + 1))};
    add_triangle(top_left, apex, top_right);
  } else {
    const auto& p = mesh_.positions;
    const double falling = length_squared(p[top_left.position] - p[bottom_right.position]);
    const double rising = length_squared(p[bottom_left.position] - p[top_right.position]);
    if (falling <= rising) {
      add_triangle(top_left, bottom_left, bottom_right);
      add_triangle(top_left, bottom_right, top_right);
    } else {
      add_triangle(top_left, bottom_left, top_right);
      add_triangle(bottom_left, bottom_right, top_right);
    }
  }
}

void MeshBuilder::add_patch(int columns, int rows, const PatchFunction& vertex) {
  const auto row_of = [&](int j) {
    std::vector<GridVertex> row;
    std::vector<Vertex> values;
    bool pole = true;
    for (int i = 0; i <= columns; ++i) {
      values.push_back(vertex(i, j));
      row.push_back({add_position(values.back().position), no_index});
      pole = pole && row.back().position == row.front().position;
    }
    // Triangles at a pole bring attributes of their own.
    if (!pole)
      for (std::size_t i = 0; i < row.size(); ++i) row[i].attribute = add_attribute(values[i]);
    return row;
  };
  std::vector<GridVertex> above = row_of(0);
  for (int j = 0; j < rows; ++j) {
    std::vector<GridVertex> below = row_of(j + 1);
    for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i)
      add_quad({above[i], below[i], below[i + 1], above[i + 1]}, vertex, static_cast<double>(i), j);
    above = std::move(below);
  }
}

TriangleMesh MeshBuilder::finish() && {
  return std::move(mesh_);
}

}  // namespace alabaster
