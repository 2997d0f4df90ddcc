#pragma once

#include <filesystem>
#include <string>

/// What a headless browser made of a page.
struct BrowserView {
  int images = 0;         // <img> elements with a source
  int broken_images = 0;  // of those, the ones that did not decode
  int sliders = 0;
  int stuck_sliders = 0;      // moving the handle or choosing another picture changed nothing
  int unlabelled = 0;         // pictures without an alternative text, controls without a label
  int requests = 0;           // anything the page fetched, data: apart
  std::string console;        // errors of scripts, one per line
  std::uintmax_t screenshot;  // bytes of the picture taken
};

/// Debian's chromium is there.
bool browser_installed();
/// Opens a copy of the page in it, moves every slider, and counts. Leaves `page`.png, a screenshot, beside
/// the page. Throws std::runtime_error when the browser says nothing.
BrowserView view_in_browser(const std::filesystem::path& page);
