#include "tests/contract/test_server.h"

#include <chrono>
#include <sstream>
#include <thread>

#include "server/api/access.h"
#include "server/api/answer.h"
#include "server/obs/log.h"
#include "server/obs/metrics.h"
#include "server/store/sqlite_store.h"

namespace tests::contract {

TestServer::TestServer(const std::function<void(server::Config&)>& adjust) {
  server::obs::set_log_level(*server::obs::log_level_named("off"));
  config_.data_dir = folder_.path();
  if (adjust) adjust(config_);
  auto store = server::store::open_sqlite_store(config_.data_dir);
  if (!store) throw std::runtime_error(store.error().message);
  auto catalogue = server::app::Catalogue::open(std::move(*store), config_.limits, config_.history,
                                                folder_.path() / "scratch");
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  catalogue_ = std::move(*catalogue);
  jobs_ = std::make_unique<server::jobs::JobQueue>(server::jobs::JobLimits{
      static_cast<std::size_t>(config_.jobs.workers), static_cast<std::size_t>(config_.jobs.queued),
      static_cast<std::size_t>(config_.jobs.kept)});
  context_.reset(new server::api::Context{*catalogue_, *jobs_, config_});
  server::http::ServerOptions options;
  options.worker_threads = 8;
  options.buffered_bytes = static_cast<std::uint64_t>(config_.http.buffered_bytes);
  options.memory_body_limit = static_cast<std::uint64_t>(config_.limits.body_bytes_memory);
  options.file_body_limit = static_cast<std::uint64_t>(config_.limits.upload_bytes);
  options.gate = server::api::make_gate(server::auth::Tokens(config_.auth.tokens), config_.auth.anonymous_read);
  options.upload_dir = config_.data_dir / "uploads";
  server_ = std::make_unique<server::http::Server>(options, server::api::make_router(*context_),
                                                   server::api::error_pages(),
      server::http::Observer{[](const server::http::Access& access) {
                               server::obs::metrics().http.record(access.method, access.route, access.status,
                                                                  access.seconds, access.bytes_sent);
                             },
                             {}});
  context_->connections = [this] { return server_->connections(); };
  const auto port = server_->start();
  if (!port) throw std::runtime_error(port.error().message);
  port_ = *port;
}

TestServer::~TestServer() {
  jobs_->stop();
  server_->stop();
}

RawAnswer TestServer::ask(const Ask& given) {
  Ask ask = given;
  // A link of ours may be absolute.
  constexpr std::string_view kHere = "http://test";
  if (ask.target.starts_with(kHere)) ask.target.erase(0, kHere.size());
  RawAnswer answer = support::HttpClient(port_).send(ask);
  for (const std::string& line : breaches(ask, answer)) {
    ADD_FAILURE() << ask.method << " " << ask.target << " -> " << answer.status << ": " << line << "\n"
                  << answer.body.substr(0, 500);
  }
  if (const std::string operation = operation_of(ask); !operation.empty()) {
    answered_.insert(operation + " " + std::to_string(answer.status));
  }
  return answer;
}

RawAnswer TestServer::get(std::string target, std::string fields) {
  return ask({"GET", std::move(target), {}, {}, std::move(fields)});
}

RawAnswer TestServer::post_json(std::string target, std::string body, std::string fields) {
  return ask({"POST", std::move(target), "application/json", std::move(body), std::move(fields)});
}

RawAnswer TestServer::upload(std::string target, std::string content_type, std::string body,
                             std::string fields) {
  return ask({"POST", std::move(target), std::move(content_type), std::move(body), std::move(fields)});
}

RawAnswer TestServer::remove(std::string target) {
  return ask({"DELETE", std::move(target)});
}

void TestServer::forget_history(const std::string& id) {
  const auto tin = catalogue_->find(id);
  ASSERT_TRUE(tin.ok());
  ASSERT_TRUE((*tin)->write_checkpoint().ok());
  ASSERT_TRUE(catalogue_->store().trim_journal(id, {.revisions = 0}).ok());
}

std::string TestServer::state() {
  return get("/tins?limit=1000").body;
}

Json TestServer::tin(const std::string& id) {
  return Json::parse(get("/tins/" + id).body);
}

std::string TestServer::finished(const std::string& job) {
  for (;;) {
    const std::string status = Json::parse(get(job).body).value("status", "none");
    if (status != "accepted" && status != "running") return status;
    std::this_thread::yield();
  }
}

std::set<std::string> TestServer::leftovers() const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  for (;;) {
    std::set<std::string> found;
    for (const char* folder : {"uploads", "exports", "scratch"}) {
      std::error_code none;
      for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / folder, none))
        found.insert(entry.path().string());
    }
    // An upload goes with its connection, a moment after the client has the answer.
    if (found.empty() || std::chrono::steady_clock::now() > deadline) return found;
    std::this_thread::yield();
  }
}

TestServer::Occupation::Occupation(server::jobs::JobQueue& jobs) : jobs_(jobs) {
  auto begun = std::make_shared<std::promise<void>>();
  auto running = begun->get_future();
  const auto id =
      jobs.submit("simplify", "nothing", [begun, end = let_go_.get_future().share()](tin::base::Progress&) {
        begun->set_value();
        end.wait();
        return tin::base::Result<std::string>("{}");
      });
  if (!id) throw std::runtime_error(id.error().message);
  id_ = *id;
  running.wait();
}

TestServer::Occupation::~Occupation() {
  let_go_.set_value();
  jobs_.wait(id_, std::chrono::seconds(10));
}

std::string slug(const RawAnswer& answer) {
  const Json problem = Json::parse(answer.body, nullptr, false);
  const std::string type = problem.is_object() ? problem.value("type", "") : "";
  return type.substr(type.rfind('/') + 1);
}

std::string ascii_grid(const std::vector<std::vector<double>>& rows, double nodata) {
  std::ostringstream out;
  out << "ncols " << (rows.empty() ? 0 : rows.front().size()) << "\nnrows " << rows.size()
      << "\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value " << nodata << "\n";
  for (const auto& row : rows) {
    for (const double value : row) out << value << ' ';
    out << '\n';
  }
  return out.str();
}

std::string ascii_grid(int columns, int rows) {
  std::vector<std::vector<double>> values;
  for (int row = 0; row < rows; ++row) {
    auto& line = values.emplace_back();
    for (int column = 0; column < columns; ++column) line.push_back(100 + (row * columns + column) % 97);
  }
  return ascii_grid(values);
}

}  // namespace tests::contract
