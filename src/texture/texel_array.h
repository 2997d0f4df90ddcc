#pragma once

#include "image/image_decode.h"
#include "texture/texture.h"

namespace alabaster {

enum class Encoding { srgb, linear };

/// Linear float texels of a picture: colour of integer pictures is decoded by `encoding` (float pictures are
/// linear already), alpha is always linear.
TexelArray make_texels(const DecodedImage& image, Encoding encoding);

}  // namespace alabaster
