#include "server/api/file_body.h"

#include <atomic>
#include <string>
#include <utility>

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

/// Removes a file that did not become an answer.
struct Unfinished {
  std::filesystem::path path;
  ~Unfinished() {
    std::error_code ignored;
    if (!path.empty()) std::filesystem::remove(path, ignored);
  }
};

}  // namespace

Result<void> Patience::check() const {
  if (request_.is_aborted()) return error(Code::kCancelled, "Nobody waits for this answer any more.");
  if (std::chrono::steady_clock::now() < end_) return {};
  return error(Code::kTooLarge, "Making the file takes more than " + std::to_string(seconds_) +
                                    " s, the limit here: ask for a smaller box or larger cells.");
}

tin::base::Error too_many_exports() {
  return error(Code::kTooMany, "Too many files are being made; try again.");
}

Result<http::Body> file_body(Context& context, std::string_view suffix,
                             const std::function<Result<void>(const std::filesystem::path&)>& write) {
  const Slot slot(context.exports);
  if (!slot.taken()) return too_many_exports();
  static std::atomic<std::uint64_t> made{0};
  const auto folder = context.config.data_dir / "exports";
  std::filesystem::create_directories(folder);
  Unfinished file{folder / (std::to_string(made++) + std::string(suffix))};
  if (auto written = write(file.path); !written) return written.error();
  return http::Body(http::FileBody{std::exchange(file.path, {}), true});
}

}  // namespace server::api
