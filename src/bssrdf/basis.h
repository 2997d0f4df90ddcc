#pragma once

namespace alabaster {

/// What the homogeneous basis of the models knows: a half-space, or the shape around a pair of points as
/// well.
enum class Basis { half_space, shape };

}  // namespace alabaster
