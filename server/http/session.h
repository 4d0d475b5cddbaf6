// One connection from its acceptance to its end: the only place where bytes are read and written.
// The sequence is read head, guard, admit, read body, handle, answer; see session.cc.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/http/options.h"
#include "server/http/router.h"

namespace boost::asio {
class io_context;
class thread_pool;
}  // namespace boost::asio

namespace server::http {

/// What all sessions of a server share.
struct SessionContext {
  const ServerOptions& options;
  const Router& router;
  const ErrorPages& pages;
  const Observer& observer;
  boost::asio::thread_pool& workers;
  std::string id_prefix;  // of request ids: differs from one start of the server to the next
  std::atomic<std::uint64_t> requests{0};
  std::atomic<bool> draining{false};  // no new requests
  std::atomic<bool> aborted{false};   // no new calls of handlers and sources either
  std::atomic<std::uint64_t> buffered{0};  // bytes of bodies and answers that are held; see Buffered
};

/// A connection just accepted.
struct Accepted {
  int descriptor = -1;
  bool ipv6 = false;
  std::string peer;     // the address, for the access log
  bool refuse = false;  // answer 503 and close: there are too many
};

/// Threads: every function may be called from any thread.
class Session {
 public:
  virtual ~Session() = default;

  virtual void start() = 0;

  /// Closes the connection if it waits for a request; a request on its way is finished.
  /// Requires: context.draining is set.
  virtual void drain() = 0;

  /// Closes the connection whatever it does. A handler that runs is not interrupted.
  /// Requires: context.aborted is set.
  virtual void abort() = 0;
};

/// Makes a session on an io_context that one thread runs; it keeps itself alive from start() until `on_end`,
/// its last call.
std::shared_ptr<Session> make_session(boost::asio::io_context& io, SessionContext& context, Accepted accepted,
                                      std::function<void()> on_end);

}  // namespace server::http
