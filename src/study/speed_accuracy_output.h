#pragma once

#include "study/speed_accuracy.h"

namespace alabaster {

/// chart.json (an array of rows, one per scene, method and number of samples), SCENE.svg and SCENE.png, and
/// chart.html with all of them, the images and tables.
void write_chart_result(const ChartResult& result, const ChartOptions& options);

/// CPU seconds after which a method's own noise is `noise`, from its row with the most samples, whose noise
/// is that of image and reference together.
double seconds_to_noise(const ChartRow& row, double reference_noise, double noise);

}  // namespace alabaster
