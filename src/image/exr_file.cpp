#include "image/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "core/atomic_file.h"
#include "core/error.h"

namespace alabaster {

namespace {

// Larger pictures are taken for damaged headers.
constexpr int64_t max_side = 1 << 20;
constexpr int64_t max_values = int64_t{1} << 32;

class MemoryStream : public Imf::IStream {
 public:
  MemoryStream(std::span<const uint8_t> bytes, const std::string& name)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}
  bool read(char* out, int count) override {
    const auto n = static_cast<uint64_t>(count);
    if (position_ > bytes_.size() || n > bytes_.size() - position_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(out, bytes_.data() + position_, n);
    position_ += n;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::span<const uint8_t> bytes_;
  uint64_t position_ = 0;
};

// Sorts R G B A and X Y Z of one layer into that order, the plain layer before all others.
std::tuple<std::string, int, std::string> channel_key(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
  const std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
  const std::size_t rank = last.size() == 1 ? std::string("RGBArgbaXYZ").find(last[0]) : std::string::npos;
  return {layer, rank == std::string::npos ? 99 : static_cast<int>(rank), last};
}

struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

Window window_of(const Imath::Box2i& box, const std::string& file) {
  const int64_t width = int64_t{box.max.x} - box.min.x + 1, height = int64_t{box.max.y} - box.min.y + 1;
  if (width < 1 || height < 1 || width > max_side || height > max_side)
    throw InputError(file, "has a window of " + std::to_string(width) + " x " + std::to_string(height) +
                               " pixels; the file is damaged or not a picture");
  return {box.min.x, box.min.y, static_cast<int>(width), static_cast<int>(height)};
}

bool overlap(const Window& a, const Window& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

std::vector<std::string> readable_channels(const Imf::Header& header, const std::string& file) {
  std::vector<std::string> names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw InputError(file, "channel " + std::string(c.name()),
                       "is subsampled (luminance-chroma); save the picture as RGB");
    names.emplace_back(c.name());
  }
  if (names.empty()) throw InputError(file, "has no channels");
  std::sort(names.begin(), names.end(),
            [](const auto& a, const auto& b) { return channel_key(a) < channel_key(b); });
  return names;
}

// Reads all channels of a part into an image of its data window.
Image read_data_window(Imf::MultiPartInputFile& file, int part, const Window& data,
                       const std::vector<std::string>& names, const std::string& name) {
  if (int64_t{data.width} * data.height * static_cast<int64_t>(names.size()) > max_values)
    throw InputError(name, "is larger than 16 GB in float; crop it or drop channels");
  Image image(data.width, data.height, names);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c)
    buffer.insert(
        names[c],
        Imf::Slice::Make(Imf::FLOAT, image.plane(static_cast<int>(c)), Imath::V2i(data.x, data.y), data.width,
                         data.height, sizeof(float), sizeof(float) * static_cast<std::size_t>(data.width)));
  Imf::InputPart input(file, part);
  input.setFrameBuffer(buffer);
  input.readPixels(data.y, data.y + data.height - 1);
  return image;
}

void copy_into(const Image& from, const Window& data, const Window& display, Image& to,
               const std::string& prefix) {
  for (std::size_t c = 0; c < from.channels().size(); ++c) {
    const std::string name = prefix + from.channels()[c];
    if (to.find(name) >= 0) continue;
    const int channel = to.add_channel(name);
    for (int y = 0; y < from.height(); ++y)
      for (int x = 0; x < from.width(); ++x) {
        const int px = x + data.x - display.x, py = y + data.y - display.y;
        if (px >= 0 && py >= 0 && px < to.width() && py < to.height())
          to.at(channel, px, py) = from.at(static_cast<int>(c), x, y);
      }
  }
}

ExrFile read_parts(Imf::MultiPartInputFile& file, const std::string& name) {
  ExrFile result;
  Window display = window_of(file.header(0).displayWindow(), name);
  const Window first_data = window_of(file.header(0).dataWindow(), name);
  if (!overlap(display, first_data)) display = first_data;
  result.image = Image(display.width, display.height, {});
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (header.hasType() && (header.type() == Imf::DEEPSCANLINE || header.type() == Imf::DEEPTILE))
      throw InputError(name, "holds deep data; flatten it first");
    const Window data = window_of(header.dataWindow(), name);
    const auto names = readable_channels(header, name);
    const std::string prefix = part > 0 && header.hasName() ? header.name() + "." : "";
    copy_into(read_data_window(file, part, data, names, name), data, display, result.image, prefix);
    for (auto a = header.begin(); a != header.end(); ++a)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
        result.attributes.emplace(a.name(), text->value());
  }
  return result;
}

[[noreturn]] void rethrow(const std::string& name, const std::exception& error) {
  std::string text = error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  throw InputError(name, "cannot be read as EXR (" + text + "); the file may be damaged or incomplete");
}

}  // namespace

ExrFile read_exr(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  return decode_exr({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}, path.string());
}

ExrFile decode_exr(std::span<const uint8_t> bytes, const std::string& name) {
  try {
    MemoryStream stream(bytes, name);
    Imf::MultiPartInputFile file(stream);
    return read_parts(file, name);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    rethrow(name, error);
  }
}

void write_exr(const std::filesystem::path& path, const Image& image, const ExrAttributes& attributes) {
  if (image.width() < 1 || image.height() < 1 || image.channels().empty())
    throw InputError(path.string(), "an EXR file needs at least one pixel and one channel");
  Imf::Header header(image.width(), image.height());
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < image.channels().size(); ++c) {
    const std::string& name = image.channels()[c];
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    // The library's slices are of mutable memory for reading and writing alike; writing only reads it.
    auto* plane = const_cast<float*>(image.plane(static_cast<int>(c)));
    buffer.insert(name,
                  Imf::Slice::Make(Imf::FLOAT, plane, Imath::V2i(0, 0), image.width(), image.height(),
                                   sizeof(float), sizeof(float) * static_cast<std::size_t>(image.width())));
  }
  for (const auto& [key, value] : attributes) header.insert(key, Imf::StringAttribute(value));
  try {
    write_file_atomically(path, [&](const std::filesystem::path& temporary) {
      Imf::OutputFile file(temporary.c_str(), header);
      file.setFrameBuffer(buffer);
      file.writePixels(image.height());
    });
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(path.string(), std::string("cannot be written as EXR: ") + error.what());
  }
}

}  // namespace alabaster
