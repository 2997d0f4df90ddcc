#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/vec.h"
#include "image/png_file.h"
#include "report/chart.h"

namespace alabaster {

struct ReportImage {
  Pixels8 pixels;
  std::string label;  // short name: below the picture and in a slider's lists
  std::string alt;    // what a reader who cannot see it should know; empty: the label
};

struct ReportTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // the first column heads its row
  std::vector<std::size_t> best{};  // by row: the column to emphasise; 0: none. Empty: none anywhere
};

/// A self-contained page: pictures and charts are inside the file, nothing is fetched. Reads without
/// JavaScript except for the sliders, prints, and follows the reader's dark or light setting. All text is
/// escaped.
class HtmlReport {
 public:
  explicit HtmlReport(const std::string& title, const std::string& introduction = {});

  void heading(const std::string& text, int level = 2);  // 2 to 4; level 2 makes an entry in the contents
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  void table(const ReportTable& table);
  /// Pictures side by side, shown about `width` pixels wide (small ones enlarged in whole multiples). Returns
  /// a handle for each, for sliders.
  std::vector<int> images(const std::vector<ReportImage>& pictures, const std::string& caption = {},
                          int width = 320);
  /// A slider between any two of pictures that stand on the page already (handles of images()); at first it
  /// shows the places `left` and `right` of `handles`.
  void slider(const std::vector<int>& handles, const std::string& caption, std::size_t left = 0,
              std::size_t right = 1);
  void chart(const Chart& chart, const std::string& alt);

  std::string html() const;
  void write(const std::filesystem::path& path) const;  // atomic

 private:
  std::string title_, introduction_, body_;
  std::vector<std::string> contents_;
  std::vector<std::string> labels_;  // of pictures, by handle
  std::vector<Vec2> sizes_;
  int sliders_ = 0;
};

std::string base64(const void* data, std::size_t size);
std::string escape_html(const std::string& text);

}  // namespace alabaster
