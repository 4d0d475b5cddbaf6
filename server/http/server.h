// The HTTP server: listens, serves the routes of a router, and drains when told to stop.
//
//   Server server(options, std::move(router), pages, observer);
//   const auto port = server.start();
//   if (!port) ... port.error().message ...
//   wait_for_sigterm();
//   server.stop();
#pragma once

#include <cstdint>
#include <memory>

#include "server/http/options.h"
#include "server/http/router.h"
#include "tin/base/result.h"

namespace server::http {

/// Threads: start() once; stop() from any thread but a handler's, any number of times.
class Server {
 public:
  Server(ServerOptions options, Router router, ErrorPages pages, Observer observer);
  ~Server();  // stops
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Begins to serve, and says on which port.
  ///
  /// Errors: kInvalidValue (no address, or not one of this machine; a limit below its least value),
  ///         kConflict (port taken or not permitted), kStorage (no folder for uploads), kInternal.
  tin::base::Result<std::uint16_t> start();

  /// Stops accepting, closes idle connections, lets running requests finish (with Connection: close), cuts
  /// what is left after drain_timeout, and joins the threads. A handler is waited for in any case: jobs of
  /// unknown length do not belong into one.
  void stop();

  /// How many connections are open.
  std::size_t connections() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace server::http
