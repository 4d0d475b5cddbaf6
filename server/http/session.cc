// A coroutine per connection, which stays on the thread of its io_context: the members of a session are
// touched by that thread only, except inside `on_workers`, when the coroutine waits. Handlers and body
// sources run there.
#include "server/http/session.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <boost/beast/core/buffers_suffix.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <chrono>
#include <exception>
#include <system_error>

#include "server/http/body_parser.h"
#include "server/http/exchange.h"
#include "server/http/files.h"
#include "server/http/patience.h"

namespace server::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
// One type and no other, so that nothing is looked up when an operation ends.
using Executor = asio::io_context::executor_type;
template <class T>
using awaitable = asio::awaitable<T, Executor>;
using Socket = asio::basic_stream_socket<tcp, Executor>;
using Timer = asio::basic_waitable_timer<Clock, asio::wait_traits<Clock>, Executor>;

constexpr asio::use_awaitable_t<Executor> kAwaited;

constexpr int kUnsentBytes = 128 * 1024;
constexpr std::size_t kHeadReadBytes = 4 * 1024;
constexpr std::size_t kBodyReadBytes = 64 * 1024;
constexpr std::uint64_t kLingerBytes = 16ULL << 20;
constexpr std::chrono::milliseconds kPatienceWithSilence{200};
constexpr std::chrono::milliseconds kPatienceWithReset{100};
constexpr std::chrono::milliseconds kLingerTime{5'000};
constexpr std::chrono::milliseconds kLingerTimeDraining{500};

/// Runs `job` on a worker thread; what it throws is thrown here.
template <class Job>
awaitable<void> on_workers(asio::thread_pool& workers, Job& job) {
  std::exception_ptr failure;
  auto initiate = [&workers, &job, &failure](auto handler) {
    asio::post(workers, [&job, &failure, resume = std::move(handler)]() mutable {
      try {
        job();
      } catch (...) {
        failure = std::current_exception();
      }
      auto executor = asio::get_associated_executor(resume);
      asio::post(executor, std::move(resume));
    });
  };
  co_await asio::async_initiate<const asio::use_awaitable_t<Executor>&, void()>(initiate, kAwaited);
  if (failure) std::rethrow_exception(failure);
}

class ClientSession final : public Session, public std::enable_shared_from_this<ClientSession> {
 public:
  ClientSession(asio::io_context& io, SessionContext& context, Accepted accepted,
                std::function<void()> on_end)
      : context_(context),
        options_(context.options),
        accepted_(std::move(accepted)),
        on_end_(std::move(on_end)),
        executor_(io.get_executor()),
        socket_(executor_),
        deadline_(executor_),
        pause_(executor_),
        watch_(executor_),
        in_(options_.header_bytes + 2 * kBodyReadBytes) {
    error_code ignored;
    socket_.assign(accepted_.ipv6 ? tcp::v6() : tcp::v4(), accepted_.descriptor, ignored);
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.non_blocking(true, ignored);
    // What a slow client does not take stays unmade: else the kernel would have megabytes made for each of them,
    // at the cost of all others. What is on its way does not count, so that far and fast clients lose nothing.
    ::setsockopt(accepted_.descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsentBytes, sizeof kUnsentBytes);
  }

  void start() override {
    asio::co_spawn(executor_, run(), [self = shared_from_this()](std::exception_ptr e) { self->finish(e); });
  }

  void drain() override {
    asio::post(executor_, [self = shared_from_this()] {
      error_code ignored;
      if (self->idle_) self->socket_.cancel(ignored);
      self->pause_.cancel();
    });
  }

  void abort() override {
    asio::post(executor_, [self = shared_from_this()] {
      self->close();
      self->pause_.cancel();
      if (self->attention_) self->attention_->lose();
    });
  }

 private:
  enum class Arrival { kHead, kGone, kTimeout, kTooLong };
  enum class Transfer { kWhole, kGone, kTimeout, kTooLarge, kBroken, kNoRoom };

  // --- The connection ---------------------------------------------------------------------------------

  awaitable<void> run() {
    if (accepted_.refuse) {
      Exchange exchange(context_, accepted_.peer);
      Response response = context_.pages.status(503, "this server has as many connections as it allows");
      response.headers.emplace_back("Retry-After", "2");
      co_await reply(exchange, std::move(response));
      co_return;
    }
    bool open = true;
    for (int served = 0; open; ++served) open = co_await serve_one(served);
  }

  void finish(std::exception_ptr failure) {
    if (failure) {
      try {
        std::rethrow_exception(failure);
      } catch (const std::exception& e) {
        report("", std::string("a connection was dropped: ") + e.what());
      } catch (...) {
        report("", "a connection was dropped: an exception of unknown type");
      }
    }
    disarm();
    close();
    on_end_();
  }

  void close() {
    error_code ignored;
    socket_.close(ignored);
  }

  void report(const std::string& id, const std::string& text) {
    if (context_.observer.problem) context_.observer.problem(id, text);
  }

  // --- One request ------------------------------------------------------------------------------------

  /// Serves the next request. Returns whether another may follow.
  awaitable<bool> serve_one(int served) {
    std::string raw;
    const Arrival arrival = co_await receive_head(raw, served == 0);
    if (arrival == Arrival::kGone) co_return false;
    Exchange exchange(context_, accepted_.peer);
    std::variant<Head, Refusal> read = judge_head(arrival, raw);
    if (const Refusal* refusal = std::get_if<Refusal>(&read)) {
      co_return co_await reply(exchange, context_.pages.status(refusal->status, refusal->detail));
    }
    Head& head = std::get<Head>(read);
    BodyParser parser(head);
    exchange.admit(head);
    Admission& admission = exchange.admission();
    if (!admission.answer && head.has_body()) {
      const bool there = co_await receive_body(exchange, parser, head.expects_continue);
      if (!there) co_return false;
    }
    exchange.allow_keep_alive(head.keep_alive && parser.done() &&
                              served + 1 < options_.requests_per_connection);
    if (admission.answer) co_return co_await reply(exchange, std::move(*admission.answer));
    co_return co_await handle(exchange);
  }

  std::variant<Head, Refusal> judge_head(Arrival arrival, const std::string& raw) const {
    if (arrival == Arrival::kTimeout) return Refusal{408, "the head of the request took too long"};
    if (arrival == Arrival::kTooLong) {
      const bool in_first_line = raw.find('\n') == std::string::npos;
      return in_first_line ? Refusal{414, "the request target is too long"}
                           : Refusal{431, "the header fields are too large"};
    }
    return read_head(raw, HeadLimits{options_.target_bytes, options_.header_fields});
  }

  awaitable<bool> handle(Exchange& exchange) {
    std::optional<Answer> answer = exchange.handle_quickly();
    if (answer) co_return co_await deliver(exchange, *answer);
    attention_ = std::make_shared<Attention>();
    exchange.set_attention(attention_);
    auto job = [&] {
      if (!context_.aborted) answer = exchange.handle();
    };
    watch_client(exchange.knows_interim_answers());
    co_await on_workers(context_.workers, job);
    error_code ignored;
    socket_.cancel(ignored);  // the watch
    watch_.cancel();
    attention_.reset();
    if (!answer) co_return false;
    co_return co_await deliver(exchange, *answer);
  }

  /// Notes when the client goes while a handler runs. A client that sends the next request already is not
  /// watched further.
  void watch_client(bool knows_interim_answers) {
    socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this(), attention = attention_,
                                                knows_interim_answers](error_code ec) {
      if (ec) return;
      const Peer peer = self->peer();
      const bool asks = peer == Peer::kSilent && knows_interim_answers;
      if (asks) return self->ask_whether_there(kPatienceWithSilence, attention);
      if (peer != Peer::kThere) attention->lose();
    });
  }

  /// A client that sends no more may be gone, or wait for its answer. An interim answer tells: nobody takes
  /// it when nobody is there, and the connection is reset. Asked once, when the handler takes its time.
  void ask_whether_there(Clock::duration after, std::shared_ptr<Attention> attention, bool asked = false) {
    watch_.expires_after(after);
    watch_.async_wait([self = shared_from_this(), attention = std::move(attention), asked](error_code ec) {
      if (ec || self->attention_ != attention) return;
      if (self->peer() == Peer::kGone) return attention->lose();
      if (asked) return;
      constexpr std::string_view kInterim = "HTTP/1.1 102 Processing\r\n\r\n";
      error_code failed;
      self->socket_.write_some(asio::buffer(kInterim), failed);
      if (failed) return attention->lose();
      self->ask_whether_there(kPatienceWithReset, attention, true);
    });
  }

  enum class Peer { kThere, kSilent, kGone };
  Peer peer() {
    // A reset after the end of what came in shows here only.
    pollfd state{socket_.native_handle(), POLLIN, 0};
    if (::poll(&state, 1, 0) < 0 || (state.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return Peer::kGone;
    char next = 0;
    const ssize_t got = ::recv(socket_.native_handle(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
    if (got == 0) return Peer::kSilent;
    return got > 0 || errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? Peer::kThere : Peer::kGone;
  }

  /// Answers without a handler.
  awaitable<bool> reply(Exchange& exchange, Response response) {
    Answer answer = exchange.reply(std::move(response));
    co_return co_await deliver(exchange, answer);
  }

  /// Sends the answer and, if it is the last one, ends the connection. Returns whether another may follow.
  awaitable<bool> deliver(Exchange& exchange, Answer& answer) {
    const bool whole = co_await send(answer, exchange.access());
    exchange.finish(answer, whole);
    if (!whole) {
      // Where the end of the connection is the end of the body, only a reset tells that it was cut.
      error_code ignored;
      if (answer.framing == Framing::kClose) socket_.set_option(asio::socket_base::linger(true, 0), ignored);
      co_return false;
    }
    if (!answer.keep_alive) co_await linger();
    co_return answer.keep_alive;
  }

  // --- Reading ----------------------------------------------------------------------------------------

  std::string_view buffered() const { return {static_cast<const char*>(in_.data().data()), in_.size()}; }

  /// Reads some bytes into `in_`. Returns how many; 0 when there are no more or the time is over
  /// (timed_out_).
  awaitable<std::size_t> read_some(std::size_t at_most, Clock::duration time) {
    timed_out_ = time <= Clock::duration::zero();
    if (timed_out_) co_return 0;
    arm(time);
    error_code ec;
    const std::size_t got =
        co_await socket_.async_read_some(in_.prepare(at_most), asio::redirect_error(kAwaited, ec));
    disarm();
    in_.commit(got);
    co_return got;
  }

  /// Waits for a head and moves it into `raw`. On kTooLong `raw` holds its beginning.
  awaitable<Arrival> receive_head(std::string& raw, bool first) {
    Clock::time_point deadline =
        Clock::now() + (first ? options_.header_timeout : options_.keep_alive_timeout);
    bool may_skip = true;  // one empty line before a request: some clients end a body with it
    bool begun = false;
    std::size_t scanned = 0;
    while (true) {
      if (may_skip && buffered().starts_with("\r\n")) {
        in_.consume(2);
        may_skip = false;
      }
      const std::size_t end = find_head_end(buffered(), scanned);
      if (std::min(end, in_.size()) > options_.header_bytes) {
        raw = buffered().substr(0, options_.header_bytes);
        co_return Arrival::kTooLong;
      }
      if (end != std::string_view::npos) {
        raw = buffered().substr(0, end);
        in_.consume(end);
        co_return Arrival::kHead;
      }
      scanned = in_.size() < 3 ? 0 : in_.size() - 3;
      if (in_.size() > 0 && !begun) {
        begun = true;
        if (!first) deadline = Clock::now() + options_.header_timeout;
      }
      idle_ = in_.size() == 0;
      if (idle_ && context_.draining) co_return Arrival::kGone;
      if (idle_) in_.shrink_to_fit();
      const std::size_t got = co_await read_some(kHeadReadBytes, deadline - Clock::now());
      const bool waiting = std::exchange(idle_, false);
      if (got == 0) co_return timed_out_ && !waiting ? Arrival::kTimeout : Arrival::kGone;
    }
  }

  /// Reads the body to where the route wants it, or sets the admission's answer. Returns false if the client
  /// went.
  awaitable<bool> receive_body(Exchange& exchange, BodyParser& parser, bool expects_continue) {
    Admission& admission = exchange.admission();
    Patience patience(options_.header_timeout, options_);
    if (expects_continue && in_.size() == 0) {
      const bool sent =
          co_await write({"HTTP/1.1 100 Continue\r\n\r\n", "", ""}, patience, exchange.access());
      if (!sent) co_return false;
    }
    Transfer transfer = Transfer::kBroken;
    std::string problem;
    auto code = tin::base::Code::kStorage;
    try {
      transfer = co_await transfer_body(exchange, parser, patience);
    } catch (const std::system_error& e) {
      problem = e.what();
      if (e.code() == std::errc::no_space_on_device || e.code().value() == EDQUOT)
        code = tin::base::Code::kNoSpace;
    }
    const ErrorPages& pages = context_.pages;
    if (!problem.empty()) {
      report(admission.request.id, "upload: " + problem);
      admission.answer = pages.error(tin::base::error(
          code, code == tin::base::Code::kNoSpace ? "there is no room on the disk for the upload"
                                                  : "the upload could not be stored"));
    } else if (transfer == Transfer::kTimeout) {
      admission.answer = pages.status(408, "the request body came too slowly");
    } else if (transfer == Transfer::kTooLarge) {
      admission.answer = too_large(pages, admission.body_limit);
    } else if (transfer == Transfer::kBroken) {
      admission.answer = pages.status(400, "the request body is not framed correctly");
    }
    co_return transfer != Transfer::kGone;
  }

  awaitable<Transfer> transfer_body(Exchange& exchange, BodyParser& parser, Patience& patience) {
    Admission& admission = exchange.admission();
    parser.set_limits(admission.body_limit, options_.header_bytes);
    std::unique_ptr<UploadFile> upload;
    std::vector<char> block(kBodyReadBytes);
    BodyParser::Step step;
    auto store = [&] {
      if (!upload) upload = std::make_unique<UploadFile>(options_.upload_dir);
      upload->write(block.data(), step.filled);
    };
    do {
      step = parser.parse(buffered(), block);
      in_.consume(step.used);
      if (step.filled > 0 && admission.to_file) co_await on_workers(context_.workers, store);
      if (step.filled > 0 && !admission.to_file) {
        admission.request.body.append(block.data(), step.filled);
        if (!exchange.hold_body()) co_return Transfer::kNoRoom;
      }
      if (step.state == BodyParser::State::kTooLarge) co_return Transfer::kTooLarge;
      if (step.state == BodyParser::State::kBroken) co_return Transfer::kBroken;
      if (step.state != BodyParser::State::kNeedMore) continue;
      const Clock::time_point before = Clock::now();
      const std::size_t got = co_await read_some(kBodyReadBytes, patience.left());
      patience.record(got, Clock::now() - before);
      if (got == 0) co_return timed_out_ ? Transfer::kTimeout : Transfer::kGone;
    } while (step.state != BodyParser::State::kDone);
    if (upload) admission.request.body_file = upload->release();
    co_return Transfer::kWhole;
  }

  // --- Writing ----------------------------------------------------------------------------------------

  awaitable<bool> send(Answer& answer, Access& access) {
    Patience patience(options_.stall_timeout, options_);
    if (!answer.source) co_return co_await write({answer.head, answer.body, ""}, patience, access);
    bool whole = co_await write({answer.head, "", ""}, patience, access);
    if (whole) whole = co_await pump(answer, patience, access);
    auto drop = [&] { answer.source.reset(); };
    co_await on_workers(context_.workers, drop);
    co_return whole;
  }

  /// Moves the pieces of a source to the client, one after the other.
  awaitable<bool> pump(Answer& answer, Patience& patience, Access& access) {
    std::string piece;
    std::string problem;
    bool more = false;
    auto pull = [&] {
      piece.clear();
      try {
        more = answer.source->next(piece);
      } catch (const std::exception& e) {
        problem = std::string("the answer was cut: ") + e.what();
      } catch (...) {
        problem = "the answer was cut: an exception of unknown type";
      }
    };
    while (true) {
      if (context_.aborted) co_return false;
      co_await on_workers(context_.workers, pull);
      if (!problem.empty()) {
        report(access.request_id, problem);
        co_return false;
      }
      if (!more || (piece.empty() && context_.draining)) break;
      bool sent = true;
      if (piece.empty()) {
        co_await pause();
      } else if (answer.framing == Framing::kChunked) {
        const std::string size = chunk_header(piece.size());
        sent = co_await write({size, piece, "\r\n"}, patience, access);
      } else {
        sent = co_await write({piece, "", ""}, patience, access);
      }
      if (!sent) co_return false;
    }
    if (answer.framing != Framing::kChunked) co_return true;
    co_return co_await write({"0\r\n\r\n", "", ""}, patience, access);
  }

  static std::string chunk_header(std::size_t size) {
    std::array<char, 24> text{};
    const int length = std::snprintf(text.data(), text.size(), "%zx\r\n", size);
    return std::string(text.data(), static_cast<std::size_t>(length));
  }

  /// Writes the parts one behind the other. Returns whether all of it went.
  awaitable<bool> write(std::array<std::string_view, 3> parts, Patience& patience, Access& access) {
    const std::array<asio::const_buffer, 3> buffers = {asio::buffer(parts[0]), asio::buffer(parts[1]),
                                                       asio::buffer(parts[2])};
    beast::buffers_suffix<std::array<asio::const_buffer, 3>> rest(buffers);
    while (asio::buffer_size(rest) > 0) {
      const Clock::duration time = patience.left();
      if (time <= Clock::duration::zero()) co_return false;
      error_code ec;
      // Most answers fit the socket's buffer: they need no clock, and no turn of the reactor.
      std::size_t sent = socket_.write_some(rest, ec);
      if (ec == asio::error::would_block) {
        const Clock::time_point before = Clock::now();
        arm(time);
        sent = co_await socket_.async_write_some(rest, asio::redirect_error(kAwaited, ec));
        disarm();
        patience.record(0, Clock::now() - before);
      }
      patience.record(sent, Clock::duration::zero());
      access.bytes_sent += sent;
      rest.consume(sent);
      if (ec) co_return false;
    }
    co_return true;
  }

  awaitable<void> pause() {
    error_code ignored;
    pause_.expires_after(options_.poll_interval);
    if (context_.draining) co_return;
    co_await pause_.async_wait(asio::redirect_error(kAwaited, ignored));
  }

  /// Ends the sending side and reads on for a while: closing on unread bytes would reset the connection, and
  /// the client could lose the answer.
  awaitable<void> linger() {
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    const Clock::time_point end = Clock::now() + (context_.draining ? kLingerTimeDraining : kLingerTime);
    std::uint64_t dropped = 0;
    while (dropped < kLingerBytes) {
      in_.consume(in_.size());
      const std::size_t got = co_await read_some(kBodyReadBytes, end - Clock::now());
      if (got == 0) co_return;
      dropped += got;
    }
  }

  // --- The deadline -----------------------------------------------------------------------------------

  /// Cancels the socket's operation after `time`, unless disarm() comes first.
  void arm(Clock::duration time) {
    timed_out_ = false;
    deadline_.expires_after(time);
    deadline_.async_wait([self = shared_from_this(), turn = ++turn_](error_code ec) {
      if (ec || turn != self->turn_) return;
      self->timed_out_ = true;
      error_code ignored;
      self->socket_.cancel(ignored);
    });
  }

  void disarm() {
    ++turn_;
    deadline_.cancel();
  }

  SessionContext& context_;
  const ServerOptions& options_;
  const Accepted accepted_;
  const std::function<void()> on_end_;
  const Executor executor_;
  Socket socket_;
  Timer deadline_;
  Timer pause_;
  Timer watch_;
  beast::flat_buffer in_;   // bytes received and not used yet
  std::uint64_t turn_ = 0;  // which arm() a deadline belongs to
  bool timed_out_ = false;
  std::shared_ptr<Attention> attention_;  // while a handler runs
  bool idle_ = false;  // waits for a request of which nothing has come
};

}  // namespace

std::shared_ptr<Session> make_session(asio::io_context& io, SessionContext& context, Accepted accepted,
                                      std::function<void()> on_end) {
  return std::make_shared<ClientSession>(io, context, std::move(accepted), std::move(on_end));
}

}  // namespace server::http
