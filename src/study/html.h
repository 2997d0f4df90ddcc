#pragma once

#include <string>
#include <vector>

#include "image/png_file.h"

namespace alabaster::html {

// The little HTML that reports are made of. Pages hold everything they show.

std::string escape(const std::string& text);
/// An <img> with the picture inside; pixels stay pixels when enlarged.
std::string image(const Pixels8& pixels, const std::string& alternative);
/// A picture with its caption; with a `choice`, the section's slider offers it under that name.
std::string figure(const std::string& image, const std::string& caption, const std::string& choice = "");
/// A comparison of any two of the figures of the section it stands in, divided by a movable line.
std::string slider(const std::string& name);

class Table {
 public:
  explicit Table(const std::string& caption);
  /// Cells are HTML. The first of a row is its heading.
  void head(const std::vector<std::string>& cells);
  void row(const std::vector<std::string>& cells);
  std::string text() const { return "<div class=wide><table>" + text_ + "</tbody></table></div>"; }

 private:
  std::string text_;
};

/// A whole document with style and script; `body` is HTML.
std::string page(const std::string& title, const std::string& body);

}  // namespace alabaster::html
