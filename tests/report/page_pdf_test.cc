#include "pilotage/report/page_pdf.h"

#include <csignal>
#include <cstdlib>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// A program that stands in for the browser: it gets the same options.
std::string script(const testing::TemporaryFolder& folder, const std::string& name, const std::string& body) {
  const fs::path path = folder / name;
  write_file(path, "#!/bin/sh\nfor last do case $last in --print-to-pdf=*) pdf=${last#*=};; esac; done\n" + body + "\n",
             true);
  fs::permissions(path, fs::perms::owner_all);
  return path.string();
}

TEST(PagePdf, PrintsThePageAndTellsNoTime) {
  const testing::TemporaryFolder folder;
  const fs::path html = folder / "a page #1 100%.html";
  write_file(html, "<p>", false);
  const std::string browser = script(folder, "browser",
                                     "printf '%%PDF-1.4\\n/CreationDate (D:20261121193459+00)\\n/ModDate "
                                     "(D:20261121193459+00)\\n%s' \"$last\" > \"$pdf\"");
  print_page_to_pdf(html, folder / "page.pdf", {.browser = browser});
  const std::string pdf = read_file(folder / "page.pdf");
  EXPECT_THAT(pdf, HasSubstr("/CreationDate (D:20000101000000+00)"));
  EXPECT_THAT(pdf, HasSubstr("/ModDate (D:20000101000000+00)"));
  EXPECT_THAT(pdf, HasSubstr("file:///"));
  EXPECT_THAT(pdf, HasSubstr("/a%20page%20%231%20100%25.html"));
}

TEST(PagePdf, TheBrowserHasNoNetworkAndASandboxUnlessItIsRoot) {
  const auto user = print_arguments("a.html", "a.pdf", "profile", false);
  EXPECT_THAT(user, Contains("--host-resolver-rules=MAP * ~NOTFOUND"));
  EXPECT_THAT(user, Contains("--disable-background-networking"));
  EXPECT_THAT(user, Not(Contains("--no-sandbox")));
  EXPECT_THAT(print_arguments("a.html", "a.pdf", "profile", true), Contains("--no-sandbox"));
}

TEST(PagePdf, SaysWhatToInstall) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(testing::error_of<DataError>([&] { find_browser((folder / "nothing").string()); }),
              HasSubstr("apt-get install chromium"));
  const char* path = std::getenv("PATH");
  const std::string before = path != nullptr ? path : "";
  ::setenv("PATH", folder.path().c_str(), 1);
  const std::string message = testing::error_of<DataError>([] { find_browser(""); });
  const std::string found = script(folder, "google-chrome", "exit 0");
  EXPECT_EQ(find_browser(""), fs::path(found));
  ::setenv("PATH", before.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("none is installed"));
  EXPECT_THAT(message, HasSubstr("apt-get install chromium"));
  EXPECT_THAT(message, HasSubstr("--pdf-browser"));
}

TEST(PagePdf, SaysWhatTheBrowserSaidWhenItFails) {
  const testing::TemporaryFolder folder;
  const auto fails = [&](const std::string& body) {
    const std::string browser = script(folder, "browser", body);
    return testing::error_of<DataError>(
        [&] { print_page_to_pdf(folder / "a.html", folder / "a.pdf", {.browser = browser}); });
  };
  EXPECT_THAT(fails("echo first; echo no display >&2; exit 3"),
              HasSubstr("ended with 3 instead of printing the page; it said: no display"));
  EXPECT_THAT(fails("echo quietly done"), HasSubstr("wrote no PDF; it said: quietly done"));
  EXPECT_THAT(fails("echo not a pdf > \"$pdf\""), HasSubstr("wrote no PDF"));
  EXPECT_THAT(fails("kill -9 $$"), HasSubstr("was ended by signal 9"));
  EXPECT_FALSE(fs::exists(folder / "a.pdf"));
}

TEST(PagePdf, EndsABrowserThatHangsAndAllThatItStarted) {
  const testing::TemporaryFolder folder;
  const std::string browser =
      script(folder, "browser", "sleep 1000 & echo $! > " + (folder / "child").string() + "; wait");
  EXPECT_THAT(testing::error_of<DataError>([&] {
                print_page_to_pdf(folder / "a.html", folder / "a.pdf", {.browser = browser, .timeout_s = 0.5});
              }),
              HasSubstr("within 0.5 s"));
  if (!fs::exists(folder / "child")) return;  // a machine so slow that the script was ended before
  const pid_t child = std::stoi(read_file(folder / "child"));
  bool gone = false;
  for (int i = 0; i < 500 && !gone; ++i) {
    gone =
        ::kill(child, 0) != 0 || read_file("/proc/" + std::to_string(child) + "/stat").find(") Z") != std::string::npos;
    if (!gone) ::usleep(10000);
  }
  EXPECT_TRUE(gone);
}

TEST(PagePdf, StopsWhenAskedTo) {
  const testing::TemporaryFolder folder;
  const std::string browser = script(folder, "browser", "sleep 1000");
  EXPECT_THROW(print_page_to_pdf(folder / "a.html", folder / "a.pdf", {.browser = browser},
                                 [](std::string_view, std::int64_t, std::int64_t) { return false; }),
               Interrupted);
}

}  // namespace
}  // namespace pilotage
