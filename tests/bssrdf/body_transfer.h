#pragma once

#include <array>
#include <vector>

#include "analytic_bodies.h"
#include "core/parallel.h"
#include "optics/profile_table.h"

namespace alabaster {

/// Ways to light a body, seen from the exit: uniformly; from the front and from the back of the exit by a far
/// light that casts no shadow (E = max(0, n . l)).
enum class TransferLight { uniform, front, back };
inline constexpr int body_light_count = 3;

inline double irradiance(TransferLight light, const Vec3& normal, const Vec3& exit_normal) {
  const double cosine = glm::dot(normal, exit_normal);
  return light == TransferLight::uniform ? 1
                                         : std::max(0.0, light == TransferLight::front ? cosine : -cosine);
}

inline constexpr std::array<double, 4> body_albedos{0.5, 0.8, 0.95, 0.99};

/// Radiosity of an exit, [albedo][light], with standard errors.
struct BodyRadiosity {
  std::array<std::array<double, body_light_count>, body_albedos.size()> value{}, standard_error{};
};

/// By walks from the exit (reciprocity), light that scattered at least once.
inline BodyRadiosity walk_radiosity(const AnalyticBody& body, const Vec3& exit, uint64_t photons,
                                    const WalkMedium& medium) {
  BodyRadiosity sum, square;
  const Vec3 exit_normal = body.normal(exit);
  const Frame frame(-exit_normal);
  Rng rng(7, 1);
  for (uint64_t k = 0; k < photons; ++k) {
    Photon photon;
    photon.position = exit;
    photon.direction = frame.to_world(sample_diffuse_entry(medium.eta, rng));
    const WalkEnd end = walk(body, medium, photon, rng, [](const Photon& p, Rng&) { return p.order < 1500; });
    if (end == WalkEnd::stopped || photon.order == 0) continue;
    const Vec3 normal = body.normal(photon.position);
    for (std::size_t a = 0; a < body_albedos.size(); ++a) {
      const double weight = std::pow(body_albedos[a], static_cast<double>(photon.order));
      for (int l = 0; l < body_light_count; ++l) {
        const double score = weight * irradiance(static_cast<TransferLight>(l), normal, exit_normal);
        sum.value[a][static_cast<std::size_t>(l)] += score;
        square.value[a][static_cast<std::size_t>(l)] += score * score;
      }
    }
  }
  const auto n = static_cast<double>(photons);
  for (std::size_t a = 0; a < body_albedos.size(); ++a)
    for (std::size_t l = 0; l < body_light_count; ++l) {
      const double mean = sum.value[a][l] / n;
      sum.value[a][l] = mean;
      sum.standard_error[a][l] = std::sqrt(std::max(0.0, square.value[a][l] / n - mean * mean) / n);
    }
  return sum;
}

/// One place of the quadrature over the surface: what S is asked there.
struct BodyCell {
  PointShape shape;
  Vec3 position;
  double area;
};

/// Cells that grow with the distance from the exit.
class BodyCells {
 public:
  BodyCells(const AnalyticBody& body, const Vec3& exit) : body_(body), exit_(exit) {
    for (const auto& patch : body.patches)
      for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) add(patch, Vec2(i, j) / 8.0, 1.0 / 8);
  }
  const std::vector<BodyCell>& cells() const { return cells_; }

 private:
  void add(const std::function<Vec3(Vec2)>& patch, Vec2 corner, double side) {
    const Vec3 a = patch(corner), b = patch(corner + Vec2(side, 0)), c = patch(corner + Vec2(side)),
               d = patch(corner + Vec2(0, side)), middle = patch(corner + Vec2(0.5 * side));
    const double size = std::max({glm::distance(a, middle), glm::distance(b, middle),
                                  glm::distance(c, middle), glm::distance(d, middle)});
    const double away = glm::distance(middle, exit_);
    if (size > 0.001 && size > 0.15 * away) {
      for (const Vec2 half : {Vec2(0, 0), Vec2(0.5, 0), Vec2(0, 0.5), Vec2(0.5, 0.5)})
        add(patch, corner + side * half, 0.5 * side);
      return;
    }
    const double area = 0.5 * glm::length(glm::cross(c - a, d - b));
    // The mean of 1/distance over a square around the exit is that at 0.284 of its side.
    Vec3 position = middle;
    if (away < 0.2 * size) position = exit_ + 0.284 * std::sqrt(area) * Frame(body_.normal(exit_)).tangent;
    if (area > 0) cells_.push_back({PointShape(body_.shape(middle), 1024), position, area});
  }

  const AnalyticBody& body_;
  Vec3 exit_;
  std::vector<BodyCell> cells_;
};

/// The same radiosity by quadrature of a basis S(entry, exit, albedo).
template <typename Basis>
BodyRadiosity predicted_radiosity(const std::vector<BodyCell>& cells, const Vec3& exit,
                                  const PointShape& shape, const Basis& basis) {
  BodyRadiosity result;
  for (const BodyCell& cell : cells) {
    std::array<double, body_light_count> e{};
    for (int l = 0; l < body_light_count; ++l)
      e[static_cast<std::size_t>(l)] =
          cell.area * irradiance(static_cast<TransferLight>(l), cell.shape.normal, shape.normal);
    for (std::size_t a = 0; a < body_albedos.size(); ++a) {
      const double s = basis(cell.position, cell.shape, exit, shape, body_albedos[a]);
      for (std::size_t l = 0; l < body_light_count; ++l) result.value[a][l] += s * e[l];
    }
  }
  return result;
}

}  // namespace alabaster
