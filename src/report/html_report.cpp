#include "report/html_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "core/atomic_file.h"

namespace alabaster {

namespace {

constexpr const char* style = R"css(
:root { color-scheme: light dark; --ink: #1a1a1a; --paper: #fff; --line: #bbb; --soft: #f2f2f2; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --paper: #17181a; --line: #555; --soft: #24262a; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2, h3, h4 { line-height: 1.2; margin: 2rem 0 .6rem; }
nav ul { columns: 20rem; padding-left: 1.2rem; }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { padding: .25rem .7rem; border-bottom: 1px solid var(--line); text-align: right; }
th[scope=row], thead th:first-child { text-align: left; }
thead th { background: var(--soft); }
.scroll { overflow-x: auto; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; margin: 1rem 0; }
figure { margin: 0; }
.row figure { flex: 0 1 auto; min-width: 0; }
.row figcaption { max-width: 22rem; overflow-wrap: anywhere; }
figcaption { font-size: .9rem; margin-top: .2rem; }
img { max-width: 100%; height: auto; }
.pixels { image-rendering: pixelated; }
img.chart { background: #fff; }
.compare { margin: 1rem 0; }
.stage { position: relative; overflow: hidden; max-width: 100%; }
.stage img { display: block; width: 100%; }
.stage img.left { position: absolute; inset: 0; height: 100%; }
.stage .bar { position: absolute; top: 0; bottom: 0; width: 2px; background: #fff; outline: 1px solid #000; pointer-events: none; }
.controls { display: flex; flex-wrap: wrap; gap: .4rem 1rem; margin: .4rem 0; align-items: center; }
.controls input[type=range] { flex: 1 1 16rem; }
@media print {
  :root { --ink: #000; --paper: #fff; --soft: #eee; }
  body { max-width: none; margin: 0; font-size: 10pt; }
  nav, .compare { display: none; }
  figure, table, tr { break-inside: avoid; }
  h2, h3, h4 { break-after: avoid; }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
)css";

constexpr const char* script = R"js(
document.querySelectorAll('.compare').forEach(function (box) {
  var left = box.querySelector('img.left'), right = box.querySelector('img.right');
  var bar = box.querySelector('.bar'), range = box.querySelector('input[type=range]');
  var lists = box.querySelectorAll('select'), stage = box.querySelector('.stage');
  function show(target, list, side) {
    var picture = document.getElementById(list.value);
    target.src = picture.src;
    target.alt = side + ': ' + picture.alt;
  }
  function move() {
    left.style.clipPath = 'inset(0 ' + (100 - range.value) + '% 0 0)';
    bar.style.left = 'calc(' + range.value + '% - 1px)';
  }
  function drag(event) {
    if (event.buttons !== 1) return;
    var area = stage.getBoundingClientRect();
    range.value = Math.max(0, Math.min(100, 100 * (event.clientX - area.left) / area.width));
    move();
    event.preventDefault();
  }
  lists[0].addEventListener('change', function () { show(left, lists[0], 'Left'); });
  lists[1].addEventListener('change', function () { show(right, lists[1], 'Right'); });
  range.addEventListener('input', move);
  stage.addEventListener('pointerdown', drag);
  stage.addEventListener('pointermove', drag);
  show(left, lists[0], 'Left'); show(right, lists[1], 'Right'); move();
  box.hidden = false;
});
)js";

/// Small pictures are shown larger, in whole multiples.
int display_width(int width, int wanted) {
  return width * std::max(1, wanted / std::max(1, width));
}

std::string select_list(const std::string& id, const std::string& label, const std::vector<int>& handles,
                        const std::vector<std::string>& labels, std::size_t selected) {
  std::string html = fmt::format("<label for=\"{}\">{}</label> <select id=\"{}\">", id, label, id);
  for (std::size_t i = 0; i < handles.size(); ++i)
    html += fmt::format("<option value=\"picture-{}\"{}>{}</option>", handles[i],
                        i == selected ? " selected" : "",
                        escape_html(labels[static_cast<std::size_t>(handles[i])]));
  return html + "</select>";
}

}  // namespace

std::string base64(const void* data, std::size_t size) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* bytes = static_cast<const uint8_t*>(data);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    const uint32_t word = static_cast<uint32_t>(bytes[i]) << 16 |
                          (left > 1 ? static_cast<uint32_t>(bytes[i + 1]) << 8 : 0) |
                          (left > 2 ? static_cast<uint32_t>(bytes[i + 2]) : 0);
    for (std::size_t d = 0; d < 4; ++d) text += d <= left ? digits[(word >> (18 - 6 * d)) & 63] : '=';
  }
  return text;
}

std::string escape_html(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

HtmlReport::HtmlReport(const std::string& title, const std::string& introduction)
    : title_(title), introduction_(introduction) {}

void HtmlReport::heading(const std::string& text, int level) {
  assert(level >= 2 && level <= 4);
  if (level == 2) {
    body_ += fmt::format("<h2 id=\"section-{}\">{}</h2>\n", contents_.size(), escape_html(text));
    contents_.push_back(text);
  } else {
    body_ += fmt::format("<h{}>{}</h{}>\n", level, escape_html(text), level);
  }
}

void HtmlReport::paragraph(const std::string& text) {
  body_ += "<p>" + escape_html(text) + "</p>\n";
}

void HtmlReport::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += "<li>" + escape_html(item) + "</li>\n";
  body_ += "</ul>\n";
}

void HtmlReport::table(const ReportTable& table) {
  body_ += "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + escape_html(table.caption) +
           "\"><table>\n<caption>" + escape_html(table.caption) + "</caption>\n<thead><tr>";
  for (const std::string& cell : table.header) body_ += "<th scope=\"col\">" + escape_html(cell) + "</th>";
  body_ += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto& row = table.rows[r];
    body_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string text = escape_html(row[i]);
      const bool best = i > 0 && r < table.best.size() && table.best[r] == i;
      body_ += i == 0 ? "<th scope=\"row\">" + text + "</th>"
               : best ? "<td><strong>" + text + "</strong></td>"
                      : "<td>" + text + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

std::vector<int> HtmlReport::images(const std::vector<ReportImage>& pictures, const std::string& caption,
                                    int width) {
  std::vector<int> handles;
  body_ += "<div class=\"row\">\n";
  for (const ReportImage& picture : pictures) {
    const int handle = static_cast<int>(labels_.size());
    const auto png = encode_png(picture.pixels);
    body_ += fmt::format(
        "<figure><img id=\"picture-{}\" class=\"pixels\" width=\"{}\" alt=\"{}\" "
        "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        handle, display_width(picture.pixels.width, width),
        escape_html(picture.alt.empty() ? picture.label : picture.alt), base64(png.data(), png.size()),
        escape_html(picture.label));
    labels_.push_back(picture.label);
    sizes_.emplace_back(picture.pixels.width, picture.pixels.height);
    handles.push_back(handle);
  }
  body_ += "</div>\n";
  if (!caption.empty()) paragraph(caption);
  return handles;
}

void HtmlReport::slider(const std::vector<int>& handles, const std::string& caption, std::size_t left,
                        std::size_t right) {
  assert(handles.size() >= 2 && left < handles.size() && right < handles.size());
  const int id = sliders_++;
  int width = 0;
  for (const int handle : handles)
    width = std::max(width, display_width(static_cast<int>(sizes_[static_cast<std::size_t>(handle)].x), 480));
  body_ += fmt::format(
      "<figure class=\"compare\" hidden><figcaption>{}</figcaption>\n<div class=\"controls\">{} {} ",
      escape_html(caption), select_list(fmt::format("left-{}", id), "Left", handles, labels_, left),
      select_list(fmt::format("right-{}", id), "Right", handles, labels_, right));
  body_ += fmt::format(
      "<label for=\"split-{}\">Divide at</label> <input id=\"split-{}\" type=\"range\" min=\"0\" max=\"100\" "
      "step=\"0.5\" value=\"50\"></div>\n"
      "<div class=\"stage\" style=\"width:{}px\"><img class=\"right pixels\" alt=\"\">"
      "<img class=\"left pixels\" alt=\"\"><div class=\"bar\"></div></div></figure>\n",
      id, id, width);
}

void HtmlReport::chart(const Chart& chart, const std::string& alt) {
  const std::string svg = chart_svg(chart);
  body_ += fmt::format(
      "<figure><img class=\"chart\" width=\"{}\" alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">"
      "<figcaption>{}</figcaption></figure>\n",
      chart.width, escape_html(alt), base64(svg.data(), svg.size()), escape_html(chart.title));
}

std::string HtmlReport::html() const {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" "
      "href=\"data:,\">\n";
  page +=
      "<title>" + escape_html(title_) + "</title>\n<style>" + style + "</style>\n</head>\n<body>\n<main>\n";
  page += "<h1>" + escape_html(title_) + "</h1>\n";
  if (!introduction_.empty()) page += "<p>" + escape_html(introduction_) + "</p>\n";
  if (contents_.size() > 1) {
    page += "<nav aria-label=\"Contents\"><ul>\n";
    for (std::size_t i = 0; i < contents_.size(); ++i)
      page += fmt::format("<li><a href=\"#section-{}\">{}</a></li>\n", i, escape_html(contents_[i]));
    page += "</ul></nav>\n";
  }
  page += body_ + "</main>\n";
  if (sliders_ > 0) page += std::string("<script>") + script + "</script>\n";
  return page + "</body>\n</html>\n";
}

void HtmlReport::write(const std::filesystem::path& path) const {
  write_text_atomically(path, html());
}

}  // namespace alabaster
