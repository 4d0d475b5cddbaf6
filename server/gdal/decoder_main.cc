// The decoder's own side.
#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

#include "server/gdal/decoder.h"
#include "server/gdal/decoder_order.h"
#include "server/gdal/import_wire.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

constexpr std::size_t kMostOrderBytes = 1 << 20;
constexpr std::chrono::milliseconds kTellEvery{250};

bool write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

std::string read_standard_input() {
  std::string text(kMostOrderBytes, '\0');
  std::size_t size = 0;
  // The server wrote it into a file before this process began; its offset is ours to choose.
  for (ssize_t got = 1; got > 0 && size < text.size(); size += static_cast<std::size_t>(got)) {
    got = ::pread(STDIN_FILENO, text.data() + size, text.size() - size, static_cast<off_t>(size));
    if (got < 0) break;
  }
  text.resize(size);
  return text;
}

/// Tells how far the work is, now and then, until it is over.
class Teller {
 public:
  explicit Teller(const tin::base::Progress& progress)
      : thread_([this, &progress](const std::stop_token& stop) {
          std::unique_lock lock(mutex_);
          while (!over_.wait_for(lock, stop, kTellEvery, [&] { return stop.stop_requested(); })) {
            if (stop.stop_requested() || !send_progress(progress.fraction(), write_all)) return;
          }
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any over_;
  std::jthread thread_;
};

/// Sends a raster's heights as they are read, so that they are never all here. From then on nobody else
/// writes.
class SendingRows final : public RowTaker {
 public:
  explicit SendingRows(std::optional<Teller>& teller) : teller_(teller) {}
  bool begin(const Import& import) override {
    teller_.reset();
    began_ = true;
    return send_beginning(import, write_all);
  }
  bool take(std::span<const double> heights) override { return send_rows(heights, write_all); }
  bool began() const { return began_; }

 private:
  std::optional<Teller>& teller_;
  bool began_ = false;
};

/// Reads the file and sends what it holds, or why it cannot be read. False when nobody listens.
bool import_and_send(const std::filesystem::path& file, const ImportOptions& options) {
  const auto no_memory = [] {
    return send_error(error(Code::kTooLarge, "Reading the file takes more memory than the limit here"),
                      write_all);
  };
  try {
    tin::base::Progress progress;
    std::optional<Teller> teller(std::in_place, progress);
    SendingRows rows(teller);
    const auto import = import_file(file, options, &progress, &rows);
    teller.reset();
    if (!import) return send_error(import.error(), write_all);
    return rows.began() ? send_end(write_all) : send_import(*import, write_all);
  } catch (const std::bad_alloc&) {
    return no_memory();
  } catch (const std::system_error&) {  // there was none for a thread's stack
    return no_memory();
  } catch (const std::exception&) {
    return send_error(
        error(Code::kInvalidValue, "The file is damaged in a way that its decoder does not know"), write_all);
  }
}

}  // namespace

int run_decoder() {
  // Without its server it has nothing to do; should that be gone already, the pipe tells.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto order = decode_order(read_standard_input());
  if (!order) return 2;
  std::error_code problem;
  const std::filesystem::path folder = std::filesystem::current_path(problem);
  if (problem || !confine_this_process(order->limits, folder)) return kNotConfined;
  const bool sent = import_and_send(folder / kUploadName, order->options);
  // No destructors: what a hostile file may have done to memory is not to be walked through.
  ::_exit(sent ? 0 : 1);
}

}  // namespace server::gdal
