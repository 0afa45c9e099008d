#include "pilotage/report/page_pdf.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <regex>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/work_folder.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 5> kBrowsers = {"chromium", "chromium-browser", "google-chrome-stable",
                                                  "google-chrome", "microsoft-edge"};
constexpr std::uintmax_t kMaxPdfBytes = std::uintmax_t{1} << 30;

std::optional<fs::path> program_on_path(const std::string& name) {
  if (name.find('/') != std::string::npos) {
    return ::access(name.c_str(), X_OK) == 0 && !fs::is_directory(name) ? std::optional<fs::path>(name) : std::nullopt;
  }
  const char* path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin";
  for (std::size_t from = 0; from <= folders.size();) {
    const std::size_t to = std::min(folders.find(':', from), folders.size());
    const fs::path candidate = fs::path(folders.substr(from, to - from)) / name;
    if (to > from && ::access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate)) return candidate;
    from = to + 1;
  }
  return std::nullopt;
}

// A file:// address: everything but letters, digits and a few signs is escaped (RFC 3986).
std::string file_url(const fs::path& path) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string url = "file://";
  for (const char letter : fs::absolute(path).string()) {
    if (kPlain.find(letter) != std::string_view::npos) {
      url += letter;
    } else {
      const auto byte = static_cast<unsigned char>(letter);
      url += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return url;
}

// A child in a process group of its own, so that all that the browser starts can be ended with it.
class Child {
 public:
  Child(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& log) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int error = ::posix_spawn(&pid_, program.c_str(), &files, &attributes, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) throw DataError(program.string() + ": cannot be run: " + std::strerror(error));
  }
  ~Child() {
    ::kill(-pid_, SIGKILL);  // also what outlives the browser itself
    if (!status_) ::waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// The status of waitpid when it has ended.
  std::optional<int> ended() {
    int status = 0;
    if (!status_ && ::waitpid(pid_, &status, WNOHANG) == pid_) status_ = status;
    return status_;
  }

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

std::string last_words(const fs::path& log) {
  std::error_code error;
  if (!fs::exists(log, error)) return "";
  std::string text = valid_utf8(read_file(log));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

void wait_for(Child& child, const fs::path& program, const fs::path& log, double timeout_s, const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  while (!child.ended()) {
    const double passed_s = std::chrono::duration<double>(Clock::now() - start).count();
    if (passed_s > timeout_s) {
      throw DataError(program.string() + ": did not print the page within " + format_number(timeout_s) +
                      " s and was ended");
    }
    report_progress(progress, "printing the PDF", 0, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const int status = *child.ended();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  const std::string how = WIFEXITED(status) ? "ended with " + std::to_string(WEXITSTATUS(status))
                                            : "was ended by signal " + std::to_string(WTERMSIG(status));
  throw DataError(program.string() + ": " + how + " instead of printing the page; it said: " + last_words(log));
}

}  // namespace

fs::path find_browser(const std::string& wanted) {
  if (!wanted.empty()) {
    if (const auto found = program_on_path(wanted)) return *found;
    throw DataError(wanted +
                    ": is no program that can be run; a PDF is printed by Chromium (Debian: apt-get install chromium)");
  }
  std::vector<std::string> names;
  for (const char* name : kBrowsers) {
    if (const auto found = program_on_path(name)) return *found;
    names.emplace_back(name);
  }
  throw DataError("a PDF is printed by Chromium, and none is installed (looked for " + join(names, ", ") +
                  "); install it (Debian: apt-get install chromium), or name it with --pdf-browser");
}

std::vector<std::string> print_arguments(const fs::path& html, const fs::path& pdf, const fs::path& profile,
                                         bool superuser) {
  std::vector<std::string> arguments = {"--headless",
                                        "--disable-gpu",
                                        "--disable-dev-shm-usage",
                                        "--disable-quic",
                                        "--no-first-run",
                                        "--no-default-browser-check",
                                        "--disable-background-networking",
                                        "--disable-component-update",
                                        "--disable-default-apps",
                                        "--disable-extensions",
                                        "--disable-sync",
                                        "--host-resolver-rules=MAP * ~NOTFOUND",
                                        "--user-data-dir=" + fs::absolute(profile).string(),
                                        "--virtual-time-budget=10000",
                                        "--no-pdf-header-footer",
                                        "--print-to-pdf=" + fs::absolute(pdf).string()};
  if (superuser) arguments.emplace_back("--no-sandbox");
  arguments.push_back(file_url(html));
  return arguments;
}

void print_page_to_pdf(const fs::path& html, const fs::path& pdf, const PagePdfOptions& options,
                       const Progress& progress) {
  const fs::path program = find_browser(options.browser);
  const WorkFolder work(fs::temp_directory_path());  // for the browser's profile and what it says
  const fs::path log = work.path() / "log.txt";
  const fs::path printed = work.path() / "page.pdf";
  {
    Child child(program, print_arguments(html, printed, work.path() / "profile", ::geteuid() == 0), log);
    wait_for(child, program, log, options.timeout_s, progress);
  }
  std::string bytes = fs::exists(printed) ? read_file(printed, kMaxPdfBytes) : "";
  if (!bytes.starts_with("%PDF-")) {
    throw DataError(program.string() + ": wrote no PDF; it said: " + last_words(log));
  }
  const std::regex date(R"(/(CreationDate|ModDate) \(D:\d{14})");
  std::vector<std::size_t> ends;
  for (std::sregex_iterator it(bytes.cbegin(), bytes.cend(), date), end; it != end; ++it) {
    ends.push_back(static_cast<std::size_t>(it->position() + it->length()));
  }
  for (const std::size_t end : ends) bytes.replace(end - 14, 14, "20000101000000");
  write_file(pdf, bytes, true);
}

}  // namespace pilotage
