#include "support/browser.h"

#include <cstdlib>
#include <regex>
#include <stdexcept>

#include "core/atomic_file.h"
#include "support/paths.h"

namespace {

// Goes in front of everything else, so that no error escapes it.
constexpr const char* watcher = R"(<script>
var said = [];
window.addEventListener('error', function (e) { said.push(e.message || 'could not load ' + e.target.src); }, true);
console.error = function (text) { said.push(text); };
</script>)";

constexpr const char* inspector = R"(<script>
window.addEventListener('load', function () {
  var images = 0, broken = 0, stuck = 0, unlabelled = 0;
  document.querySelectorAll('img').forEach(function (i) {
    if (!i.alt) unlabelled++;
    if (!i.getAttribute('src')) return;
    images++;
    if (!i.complete || i.naturalWidth === 0) broken++;
  });
  var boxes = document.querySelectorAll('.compare');
  boxes.forEach(function (box) {
    var range = box.querySelector('input[type=range]'), left = box.querySelector('img.left');
    var lists = box.querySelectorAll('select');
    var clip = left.style.clipPath, source = left.src;
    range.value = range.value > 50 ? 10 : 90;
    range.dispatchEvent(new Event('input'));
    lists[0].selectedIndex = (lists[0].selectedIndex + 1) % lists[0].options.length;
    lists[0].dispatchEvent(new Event('change'));
    if (left.style.clipPath === clip || left.src === source) stuck++;
  });
  document.querySelectorAll('input, select').forEach(function (c) {
    if (c.labels.length === 0 && !c.getAttribute('aria-label')) unlabelled++;
  });
  var fetched = 0;
  document.querySelectorAll('[src], link[href]').forEach(function (e) {
    var from = e.getAttribute('src') || e.getAttribute('href');
    if (from && from.indexOf('data:') !== 0) fetched++;
  });
  var result = document.createElement('pre');
  result.id = 'inspection';
  result.textContent = [images, broken, boxes.length, stuck, unlabelled, fetched, said.join('|')].join(';') + ';';
  document.body.appendChild(result);
});
</script>)";

void chromium(const std::string& options, const std::filesystem::path& page,
              const std::filesystem::path& profile, const std::string& output) {
  const std::string command =
      "timeout 120 chromium --headless --no-sandbox --disable-gpu --user-data-dir=" + profile.string() + " " +
      options + " file://" + page.string() + " > " + output + " 2>/dev/null";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("chromium failed: " + command);
}

}  // namespace

bool browser_installed() {
  return std::system("command -v chromium >/dev/null 2>&1") == 0;
}

BrowserView view_in_browser(const std::filesystem::path& page) {
  using alabaster::read_text;
  ScratchFolder folder;
  std::string html = read_text(page);
  const std::size_t head = html.find("<head>");
  if (head == std::string::npos) throw std::runtime_error(page.string() + ": no <head>");
  html.insert(head + 6, watcher);
  html += inspector;
  const std::filesystem::path copy = folder / "page.html";
  alabaster::write_text_atomically(copy, html);

  const std::filesystem::path dom = folder / "dom.html";
  chromium("--dump-dom", copy, folder / "profile", dom.string());
  std::smatch found;
  const std::string text = read_text(dom);
  const std::size_t at = text.find("<pre id=\"inspection\">");
  if (at == std::string::npos) throw std::runtime_error(page.string() + ": the browser ran no script");
  const std::string report = text.substr(at, text.find("</pre>", at) - at);
  const std::regex fields(R"(>(\d+);(\d+);(\d+);(\d+);(\d+);(\d+);([^]*);$)");
  if (!std::regex_search(report, found, fields)) throw std::runtime_error("not understood: " + report);

  const std::filesystem::path picture = page.string() + ".png";
  chromium("--window-size=1200,4000 --screenshot=" + picture.string(), page, folder / "profile", "/dev/null");
  BrowserView view;
  view.images = std::stoi(found[1].str());
  view.broken_images = std::stoi(found[2].str());
  view.sliders = std::stoi(found[3].str());
  view.stuck_sliders = std::stoi(found[4].str());
  view.unlabelled = std::stoi(found[5].str());
  view.requests = std::stoi(found[6].str());
  view.console = found[7].str();
  view.screenshot = std::filesystem::exists(picture) ? std::filesystem::file_size(picture) : 0;
  return view;
}
