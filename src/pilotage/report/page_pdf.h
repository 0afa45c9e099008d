#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"

namespace pilotage {

/// How a page becomes a PDF.
struct PagePdfOptions {
  std::string browser;     ///< A program that takes Chromium's options; "" looks for one (find_browser).
  double timeout_s = 120;  ///< > 0; the browser is ended when it takes longer.
};

/// The browser to print with: `wanted`, or the first of chromium, chromium-browser, google-chrome-stable, google-chrome
/// and microsoft-edge on PATH. Throws DataError, naming what to install, when there is none, or `wanted` cannot be run.
std::filesystem::path find_browser(const std::string& wanted);

/// The options Chromium gets to print `html` into `pdf` in the profile folder `profile`: headless, no network (every
/// host unknown, no background service), no sandbox for the superuser alone (Chromium refuses it there).
std::vector<std::string> print_arguments(const std::filesystem::path& html, const std::filesystem::path& pdf,
                                         const std::filesystem::path& profile, bool superuser);

/// Prints a page from the disk into `pdf` (replaced when it exists) with its print style. The dates in the PDF are set
/// to 1 January 2000, so that the same page and browser give the same bytes. `progress` is asked now and then whether
/// to go on. Throws DataError when there is no browser, it fails (with the end of what it said), takes too long or
/// writes no PDF; Interrupted.
void print_page_to_pdf(const std::filesystem::path& html, const std::filesystem::path& pdf,
                       const PagePdfOptions& options = {}, const Progress& progress = {});

}  // namespace pilotage
