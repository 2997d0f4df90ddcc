#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "image/image.h"

namespace alabaster {

/// String attributes of an EXR header: provenance (program version, scene, options, seed ...).
using ExrAttributes = std::map<std::string, std::string>;

struct ExrFile {
  Image image;
  ExrAttributes attributes;  // those of type string
};

/// Every channel of a scanline or tiled file, half, float or uint, in float. The image is the display window;
/// pixels outside the data window are 0. Channels of one layer stand together in the order R G B A or X Y Z,
/// the plain ones first; channels of further parts carry the part's name as a prefix. Throws InputError for
/// files that are missing, damaged, deep, subsampled or absurdly large.
ExrFile read_exr(const std::filesystem::path& path);
/// The same from memory; `name` is used in messages.
ExrFile decode_exr(std::span<const uint8_t> bytes, const std::string& name);

/// All channels as 32-bit float, scanlines, ZIP compressed (lossless); the file appears whole or not at all.
void write_exr(const std::filesystem::path& path, const Image& image, const ExrAttributes& attributes = {});

}  // namespace alabaster
