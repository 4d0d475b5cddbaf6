// What the server is told when it is made: its limits, the pages it answers errors with, and who observes it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "server/http/message.h"
#include "tin/base/result.h"

namespace server::http {

struct Route;

/// Judges a request by its head, when its route is known and nothing else was done: an answer ends it. May be
/// empty. Called on any thread.
using Gate = std::function<std::optional<Response>(Request&, const Route&)>;

struct ServerOptions {
  std::string address = "127.0.0.1";  // an IPv4 or IPv6 address, not a name
  std::uint16_t port = 0;             // 0: any free one
  int io_threads = 2;
  int worker_threads = 4;  // handlers and body sources run here

  std::size_t header_bytes = 16 * 1024;  // of a request's head in all; also of a chunked body's framing
  std::size_t header_fields = 100;
  std::size_t target_bytes = 8 * 1024;
  std::uint64_t memory_body_limit = 32ULL << 20;  // for routes that state no limit of their own
  std::uint64_t file_body_limit = 2ULL << 30;
  std::uint64_t buffered_bytes = 256ULL << 20;  // of bodies in memory and of answers, all together
  std::uint64_t min_bytes_per_second = 1024;  // of a body in either direction, after its first moments
  std::size_t compress_from_bytes = 1024;     // of an answer, for clients that accept it; 0: never
  int requests_per_connection = 1000;
  int max_connections = 1000;
  int max_connections_per_address = 200;

  std::chrono::milliseconds header_timeout{10'000};  // for a head, once begun; also a body's first moments
  std::chrono::milliseconds keep_alive_timeout{75'000};  // between requests
  std::chrono::milliseconds stall_timeout{60'000};       // without any progress of a body
  std::chrono::milliseconds drain_timeout{30'000};       // for running requests when the server stops
  std::chrono::milliseconds poll_interval{200};          // between questions to a source that has nothing yet

  Gate gate;

  std::filesystem::path upload_dir;  // made if missing; empty: the system's temporary folder
};

/// Who writes the body of an error. Both may be called on any thread.
struct ErrorPages {
  /// For what has a code: no such path, unknown parameter, body too large, upload not stored.
  std::function<Response(const tin::base::Error&)> error;
  /// For what is plain HTTP (400, 405, 408, 413, 414, 417, 431, 500, 501, 503, 505); `detail` is for people.
  std::function<Response(int status, const std::string& detail)> status;
};

/// One finished exchange. `route` is the pattern (few values: good for metrics), "" if none matched.
struct Access {
  std::string request_id;
  std::string peer;
  std::string client;  // as Request::client
  std::string method;
  std::string route;
  std::string path;
  int status = 0;
  std::uint64_t bytes_sent = 0;
  double seconds = 0;
  bool cut = false;  // the answer did not reach the client whole
};

/// Who wants to know. Either may be empty; both are called on any thread and must not throw.
struct Observer {
  std::function<void(const Access&)> access;
  /// What went wrong inside: the text stays here, clients get only the id.
  std::function<void(const std::string& request_id, const std::string& text)> problem;
};

}  // namespace server::http
