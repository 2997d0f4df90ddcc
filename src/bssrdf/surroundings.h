#pragma once

#include "bssrdf/bssrdf.h"

namespace alabaster {

/// The albedo around an exit, averaged over two mean free paths; at least 1 % of the largest anywhere, so
/// that light from afar is not overlooked.
Rgb albedo_around(const BssrdfMedium& medium, const KernelPlacement& placement, const BssrdfPoint& exit);

/// Over what distance albedo_around() hardly changes, m: a quarter of its Gaussian's standard deviation.
double smooth_distance(const BssrdfMedium& medium);

}  // namespace alabaster
