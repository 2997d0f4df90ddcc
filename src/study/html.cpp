#include "study/html.h"

#include <fmt/format.h>

namespace alabaster::html {

namespace {

std::string base64(const std::vector<uint8_t>& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

constexpr const char* style = R"(
:root { color-scheme: light }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5em auto; max-width: 78em; padding: 0 1em; color: #222; background: #fff }
h1, h2, h3 { line-height: 1.2 } h3 small { color: #666; font-weight: normal }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums }
caption { text-align: left; font-weight: bold; padding: .3em 0 }
th, td { border-bottom: 1px solid #ccc; padding: .2em .7em; text-align: right; white-space: nowrap }
th:first-child { text-align: left } thead th { border-bottom: 2px solid #888 }
.wide { overflow-x: auto }
.row { display: flex; flex-wrap: wrap; gap: .8em }
figure { margin: 0; width: 170px } figure img { width: 100%; height: auto; display: block; image-rendering: pixelated; border: 1px solid #ccc; box-sizing: border-box }
figcaption { font-size: 12px; overflow-wrap: anywhere }
.compare { margin: 1em 0 } .compare .stage { position: relative; width: 400px; max-width: 100% }
.stage img { width: 100%; height: auto; display: block; image-rendering: pixelated } .stage img + img { position: absolute; top: 0; left: 0 }
.stage .line { position: absolute; top: 0; bottom: 0; width: 2px; background: #f60 }
.compare input { width: 400px; max-width: 100%; display: block }
svg { max-width: 100%; height: auto }
@media print { .compare { display: none } section, figure, table, svg { break-inside: avoid } body { margin: 0; max-width: none } .wide { overflow: visible } }
)";

constexpr const char* script = R"(
for (const box of document.querySelectorAll('.compare')) {
  const section = box.closest('section');
  const figures = [...section.querySelectorAll('figure[data-choice]')];
  const [left, right] = box.querySelectorAll('select');
  const [under, over] = box.querySelectorAll('.stage img');
  const range = box.querySelector('input'), line = box.querySelector('.line');
  for (const select of [left, right])
    for (const f of figures) select.add(new Option(f.dataset.choice));
  right.selectedIndex = figures.length - 1;
  const preferred = figures.findIndex(f => f.dataset.choice == 'composite');
  if (preferred > 0) right.selectedIndex = preferred;
  const show = () => {
    const a = figures[left.selectedIndex].querySelector('img'), b = figures[right.selectedIndex].querySelector('img');
    over.src = a.src; over.alt = a.alt; under.src = b.src; under.alt = b.alt;
    over.style.clipPath = `inset(0 ${100 - range.value}% 0 0)`;
    line.style.left = range.value + '%';
  };
  for (const control of [left, right, range]) control.addEventListener('input', show);
  show();
}
)";

}  // namespace

std::string escape(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string image(const Pixels8& pixels, const std::string& alternative) {
  return fmt::format("<img width={} height={} alt=\"{}\" src=\"data:image/png;base64,{}\">", pixels.width,
                     pixels.height, escape(alternative), base64(encode_png(pixels)));
}

std::string figure(const std::string& image, const std::string& caption, const std::string& choice) {
  const std::string data = choice.empty() ? "" : " data-choice=\"" + escape(choice) + "\"";
  return "<figure" + data + ">" + image + "<figcaption>" + caption + "</figcaption></figure>";
}

std::string slider(const std::string& name) {
  // The pictures are set by the script; until then an empty one stands in.
  constexpr const char* empty = "data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==";
  return fmt::format(
      "<div class=compare><label>Left <select></select></label> <label>right <select></select></label>"
      "<div class=stage><img alt=\"\" src=\"{1}\"><img alt=\"\" src=\"{1}\"><div class=line></div></div>"
      "<input type=range min=0 max=100 value=50 aria-label=\"dividing line between the two images of "
      "{0}\"></div>",
      escape(name), empty);
}

Table::Table(const std::string& caption) : text_("<caption>" + caption + "</caption>") {}

void Table::head(const std::vector<std::string>& cells) {
  text_ += "<thead><tr>";
  for (const std::string& cell : cells) text_ += "<th scope=col>" + cell + "</th>";
  text_ += "</tr></thead><tbody>";
}

void Table::row(const std::vector<std::string>& cells) {
  text_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i)
    text_ += i == 0 ? "<th scope=row>" + cells[i] + "</th>" : "<td>" + cells[i] + "</td>";
  text_ += "</tr>\n";
}

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
         "content=\"width=device-width\"><title>" +
         escape(title) + "</title><style>" + style + "</style></head><body>\n" + body + "\n<script>" +
         script + "</script></body></html>\n";
}

}  // namespace alabaster::html
