#include "server/cli/serve.h"

#include <pthread.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "server/api/access.h"
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/app/catalogue.h"
#include "server/app/stored_jobs.h"
#include "server/config.h"
#include "server/http/server.h"
#include "server/jobs/job_queue.h"
#include "server/obs/log.h"
#include "server/obs/metrics.h"
#include "server/store/sqlite_store.h"

namespace server::cli {

using tin::base::Result;

namespace {

int fail(const tin::base::Error& error) {
  std::fprintf(stderr, "tinsmith: %s\n", error.message.c_str());
  return 1;
}

Result<Config> read_arguments(const ServeArguments& arguments) {
  Config config;
  if (arguments.config) {
    auto read = read_config(*arguments.config);
    if (!read) return read.error();
    config = *read;
  }
  if (arguments.listen) {
    const auto listen = parse_listen(*arguments.listen);
    if (!listen) return listen.error();
    config.listen = *listen;
  }
  if (arguments.data) config.data_dir = *arguments.data;
  if (arguments.insecure) config.auth.insecure = true;
  if (auto fine = check_exposure(config); !fine) return fine.error();
  return config;
}

http::ServerOptions http_options(const Config& config) {
  const auto seconds = [](std::int64_t s) { return std::chrono::milliseconds(1000 * s); };
  http::ServerOptions options;
  options.address = config.listen.address;
  options.port = config.listen.port;
  options.io_threads = static_cast<int>(config.http.io_threads);
  // Those that may take long have threads of their own, so that they leave the short ones theirs.
  const auto by_cores = static_cast<std::int64_t>(std::max(8U, 2 * std::thread::hardware_concurrency()));
  const std::int64_t for_short = config.http.worker_threads == 0 ? by_cores : config.http.worker_threads;
  const std::int64_t for_long =
      config.limits.uploads_at_once + config.limits.exports_at_once + config.jobs.sync_waiting +
      config.limits.edits_at_once;
  options.worker_threads = static_cast<int>(for_short + for_long);
  options.header_bytes = static_cast<std::size_t>(config.http.header_bytes);
  options.header_fields = static_cast<std::size_t>(config.http.header_fields);
  options.target_bytes = static_cast<std::size_t>(config.http.target_bytes);
  options.memory_body_limit = static_cast<std::uint64_t>(config.limits.body_bytes_memory);
  options.file_body_limit = static_cast<std::uint64_t>(config.limits.upload_bytes);
  options.buffered_bytes = static_cast<std::uint64_t>(config.http.buffered_bytes);
  options.min_bytes_per_second = static_cast<std::uint64_t>(config.http.body_bytes_per_second);
  options.compress_from_bytes = static_cast<std::size_t>(config.http.compress_from_bytes);
  options.requests_per_connection = static_cast<int>(config.http.requests_per_connection);
  options.max_connections = static_cast<int>(config.http.connections);
  options.max_connections_per_address = static_cast<int>(config.http.connections_per_address);
  options.header_timeout = seconds(config.http.header_seconds);
  options.keep_alive_timeout = seconds(config.http.keep_alive_seconds);
  options.stall_timeout = seconds(config.http.stall_seconds);
  options.drain_timeout = seconds(config.http.drain_seconds);
  options.gate = api::make_gate(auth::Tokens(config.auth.tokens), config.auth.anonymous_read);
  options.upload_dir = config.data_dir / "uploads";
  return options;
}

gdal::Decoder decoder(const Config& config) {
  return {"/proc/self/exe",
          {static_cast<std::uint64_t>(config.decoder.memory_bytes),
           static_cast<std::uint64_t>(config.decoder.file_bytes),
           static_cast<int>(config.decoder.cpu_seconds), static_cast<int>(config.decoder.seconds)}};
}

http::Observer observer() {
  return {[](const http::Access& access) {
            obs::metrics().http.record(access.method, access.route, access.status, access.seconds,
                                       access.bytes_sent);
            obs::log_info("request", {{"id", access.request_id},
                                      {"peer", access.peer},
                                      {"client", access.client},
                                      {"method", access.method},
                                      {"route", access.route},
                                      {"path", access.path},
                                      {"status", access.status},
                                      {"bytes", access.bytes_sent},
                                      {"seconds", access.seconds},
                                      {"cut", access.cut}});
          },
          [](const std::string& id, const std::string& text) {
            obs::log_error("problem", {{"id", id}, {"text", text}});
          }};
}

/// What a killed server left half-received or half-made.
void clear_temporary_files(const std::filesystem::path& data_dir) {
  std::error_code ignored;
  std::filesystem::remove_all(data_dir / "uploads", ignored);
  std::filesystem::remove_all(data_dir / "exports", ignored);
  std::filesystem::remove_all(data_dir / "scratch", ignored);
}

std::string url(const Listen& listen, std::uint16_t port) {
  const bool ipv6 = listen.address.find(':') != std::string::npos;
  return "http://" + (ipv6 ? "[" + listen.address + "]" : listen.address) + ":" + std::to_string(port);
}

int wait_for_stop(const sigset_t& signals) {
  int signal = 0;
  sigwait(&signals, &signal);
  return signal;
}

}  // namespace

int serve(const ServeArguments& arguments) {
  const auto config = read_arguments(arguments);
  if (!config) return fail(config.error());
  obs::set_log_level(*obs::log_level_named(config->log_level));
  // Blocked before any thread starts, so that only wait_for_stop() receives them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error of the write, not an end of the server

  std::error_code unmade;
  std::filesystem::create_directories(config->data_dir, unmade);
  if (unmade)
    return fail({tin::base::Code::kStorage, "The data folder cannot be made: " + unmade.message(), ""});
  auto store = store::open_sqlite_store(config->data_dir);
  if (!store) return fail(store.error());
  clear_temporary_files(config->data_dir);
  const auto catalogue =
      app::Catalogue::open(std::move(*store), config->limits, config->history, config->data_dir / "scratch");
  if (!catalogue) return fail(catalogue.error());
  app::StoredJobs memory((*catalogue)->store());
  const auto earlier = memory.recall();
  if (!earlier) return fail(earlier.error());
  jobs::JobQueue jobs({static_cast<std::size_t>(config->jobs.workers),
                       static_cast<std::size_t>(config->jobs.queued),
                       static_cast<std::size_t>(config->jobs.kept)},
                      &memory, *earlier);
  api::Context context{**catalogue, jobs, *config};
  context.decoder = decoder(*config);
  http::Server server(http_options(*config), api::make_router(context), api::error_pages(), observer());
  context.connections = [&server] { return server.connections(); };
  const auto port = server.start();
  if (!port) return fail(port.error());
  std::printf("Tinsmith serves %zu TINs at %s\n", (*catalogue)->list().size(),
              url(config->listen, *port).c_str());
  std::fflush(stdout);
  obs::log_info("stopping", {{"signal", wait_for_stop(signals)}});
  // Load balancers that ask /readyz have this long to send nothing more before connections are refused.
  context.draining = true;
  std::this_thread::sleep_for(std::chrono::seconds(config->http.drain_notice_seconds));
  // Both drain at once: requests may wait for jobs, jobs for nobody.
  std::jthread jobs_draining([&] { jobs.drain(std::chrono::seconds(config->http.drain_seconds)); });
  server.stop();
  jobs_draining.join();
  obs::log_info("stopped");
  return 0;
}

}  // namespace server::cli
