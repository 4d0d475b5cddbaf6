#include "server/http/server.h"

#include <boost/asio.hpp>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "server/http/session.h"

namespace server::http {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using tin::base::Code;
using tin::base::Result;

constexpr std::chrono::milliseconds kAcceptPause{100};  // when there are no descriptors left
constexpr std::size_t kMaxRefusals = 100;  // at a time that get an answer; others are just closed

std::string random_prefix() {
  std::random_device device;
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08x-", static_cast<unsigned>(device()));
  return text.data();
}

/// The sessions alive, and how many there are of each address.
class Sessions {
 public:
  enum class Place { kGranted, kRefused, kNone };

  Sessions(int most, int most_per_address) : most_(most), most_per_address_(most_per_address) {}

  /// A place for one more connection; each but kNone is given back by leave().
  Place enter(const std::string& peer) {
    const std::lock_guard lock(mutex_);
    if (closed_) return Place::kNone;
    const auto of_peer = per_address_.find(peer);
    const bool full =
        granted_ >= most_ || (of_peer != per_address_.end() && of_peer->second >= most_per_address_);
    if (full && refused_ >= kMaxRefusals) return Place::kNone;
    if (full) {
      ++refused_;
      return Place::kRefused;
    }
    ++granted_;
    ++per_address_[peer];
    return Place::kGranted;
  }

  void leave(const std::string& peer, Place place, std::uint64_t number) {
    std::shared_ptr<Session> ended;  // outlives the lock
    const std::lock_guard lock(mutex_);
    if (const auto found = alive_.find(number); found != alive_.end()) {
      ended = std::move(found->second);
      alive_.erase(found);
    }
    if (place == Place::kRefused) {
      --refused_;
    } else {
      --granted_;
      const auto of_peer = per_address_.find(peer);
      if (--of_peer->second == 0) per_address_.erase(of_peer);
    }
    changed_.notify_all();
  }

  void keep(std::uint64_t number, std::shared_ptr<Session> session) {
    const std::lock_guard lock(mutex_);
    alive_[number] = std::move(session);
  }

  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return alive_.size();
  }

  /// No place from now on.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }

  template <class Act>
  void each(Act act) {
    const std::lock_guard lock(mutex_);
    for (const auto& [number, session] : alive_) act(*session);
  }

  void wait_until_empty() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return empty(); });
  }

  bool wait_until_empty(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [&] { return empty(); });
  }

 private:
  bool empty() const { return granted_ == 0 && refused_ == 0; }

  const int most_;
  const int most_per_address_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint64_t, std::shared_ptr<Session>> alive_;
  std::map<std::string, int> per_address_;
  int granted_ = 0;
  std::size_t refused_ = 0;
  bool closed_ = false;
};

Result<void> check_options(const ServerOptions& o) {
  const bool counts = o.io_threads > 0 && o.worker_threads > 0 && o.requests_per_connection > 0 &&
                      o.max_connections > 0 && o.max_connections_per_address > 0;
  const bool sizes =
      o.header_bytes >= 256 && o.target_bytes >= 64 && o.header_fields > 0 && o.min_bytes_per_second > 0;
  const std::chrono::milliseconds none{0};
  const bool times = o.header_timeout > none && o.keep_alive_timeout > none && o.stall_timeout > none &&
                     o.drain_timeout >= none && o.poll_interval > none;
  if (counts && sizes && times) return {};
  return tin::base::error(Code::kInvalidValue, "a limit of the HTTP server is zero, negative or too small");
}

}  // namespace

class Server::Impl {
 public:
  Impl(ServerOptions options, Router router, ErrorPages pages, Observer observer)
      : options_(std::move(options)),
        router_(std::move(router)),
        pages_(std::move(pages)),
        observer_(std::move(observer)),
        loops_(static_cast<std::size_t>(std::max(options_.io_threads, 1))),
        acceptor_(loops_.front().io),
        accept_pause_(acceptor_.get_executor()),
        workers_(static_cast<std::size_t>(std::max(options_.worker_threads, 1))),
        sessions_(options_.max_connections, options_.max_connections_per_address),
        context_{options_, router_, pages_, observer_, workers_, random_prefix()} {}

  Result<std::uint16_t> start() {
    if (Result<void> sound = check_options(options_); !sound) return sound.error();
    if (Result<void> made = make_upload_dir(); !made) return made.error();
    if (Result<void> bound = listen(); !bound) return bound.error();
    const std::uint16_t port = acceptor_.local_endpoint().port();
    asio::post(acceptor_.get_executor(), [this] { accept_next(); });
    for (Loop& loop : loops_) threads_.emplace_back([&loop] { loop.io.run(); });
    return port;
  }

  std::size_t connections() const { return sessions_.count(); }

  void stop() {
    const std::lock_guard lock(stopping_);
    if (threads_.empty()) return;
    sessions_.close();
    context_.draining = true;
    asio::post(acceptor_.get_executor(), [this] {
      error_code ignored;
      acceptor_.close(ignored);
      accept_pause_.cancel();
    });
    sessions_.each([](Session& session) { session.drain(); });
    if (!sessions_.wait_until_empty(options_.drain_timeout)) {
      context_.aborted = true;
      sessions_.each([](Session& session) { session.abort(); });
      sessions_.wait_until_empty();
    }
    for (Loop& loop : loops_) loop.work.reset();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
    workers_.join();
  }

 private:
  Result<void> make_upload_dir() {
    std::error_code ec;
    if (options_.upload_dir.empty()) options_.upload_dir = std::filesystem::temp_directory_path(ec);
    if (!ec) std::filesystem::create_directories(options_.upload_dir, ec);
    if (!ec) return {};
    return tin::base::error(Code::kStorage, "cannot make the folder for uploads " +
                                                options_.upload_dir.string() + ": " + ec.message());
  }

  Result<void> listen() {
    error_code ec;
    const asio::ip::address address = asio::ip::make_address(options_.address, ec);
    if (ec)
      return tin::base::error(Code::kInvalidValue,
                              "\"" + options_.address + "\" is not an IP address to listen on");
    const tcp::endpoint endpoint(address, options_.port);
    acceptor_.open(endpoint.protocol(), ec);
    if (!ec) acceptor_.set_option(tcp::acceptor::reuse_address(true), ec);
    if (!ec) acceptor_.bind(endpoint, ec);
    if (!ec) acceptor_.listen(asio::socket_base::max_listen_connections, ec);
    if (!ec) return {};
    error_code ignored;
    acceptor_.close(ignored);
    const bool taken = ec == asio::error::address_in_use || ec == asio::error::access_denied;
    const bool foreign = ec == boost::system::errc::address_not_available;
    return tin::base::error(taken     ? Code::kConflict
                            : foreign ? Code::kInvalidValue
                                      : Code::kInternal,
                            "cannot listen on " + options_.address + " port " +
                                std::to_string(options_.port) + ": " + ec.message());
  }

  void accept_next() {
    asio::io_context& io = loops_[accepted_count_ % loops_.size()].io;
    acceptor_.async_accept(io, [this, &io](error_code ec, tcp::socket socket) {
      if (!acceptor_.is_open()) return;
      if (!ec) {
        admit(io, std::move(socket));
        accept_next();
        return;
      }
      accept_pause_.expires_after(kAcceptPause);
      accept_pause_.async_wait([this](error_code) {
        if (acceptor_.is_open()) accept_next();
      });
    });
  }

  void admit(asio::io_context& io, tcp::socket socket) {
    error_code ec;
    const tcp::endpoint endpoint = socket.remote_endpoint(ec);
    if (ec) return;  // gone already
    Accepted accepted;
    accepted.peer = endpoint.address().to_string();
    accepted.ipv6 = endpoint.address().is_v6();
    const Sessions::Place place = sessions_.enter(accepted.peer);
    if (place == Sessions::Place::kNone) return;
    accepted.refuse = place == Sessions::Place::kRefused;
    accepted.descriptor = socket.release(ec);
    const std::uint64_t number = ++accepted_count_;
    auto on_end = [this, place, number, peer = accepted.peer] { sessions_.leave(peer, place, number); };
    auto session = make_session(io, context_, std::move(accepted), std::move(on_end));
    sessions_.keep(number, session);
    session->start();
    if (context_.draining) session->drain();  // stop() may have missed it
  }

  /// The connections of one thread.
  struct Loop {
    asio::io_context io{1};
    asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  };

  ServerOptions options_;
  Router router_;
  ErrorPages pages_;
  Observer observer_;
  std::deque<Loop> loops_;
  tcp::acceptor acceptor_;
  asio::steady_timer accept_pause_;
  asio::thread_pool workers_;
  Sessions sessions_;
  SessionContext context_;
  std::mutex stopping_;
  std::vector<std::thread> threads_;
  std::uint64_t accepted_count_ = 0;  // touched by the acceptor's thread only
};

Server::Server(ServerOptions options, Router router, ErrorPages pages, Observer observer)
    : impl_(std::make_unique<Impl>(std::move(options), std::move(router), std::move(pages),
                                   std::move(observer))) {}

Server::~Server() {
  stop();
}

tin::base::Result<std::uint16_t> Server::start() {
  return impl_->start();
}

void Server::stop() {
  impl_->stop();
}

std::size_t Server::connections() const {
  return impl_->connections();
}

}  // namespace server::http
