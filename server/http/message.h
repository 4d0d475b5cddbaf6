// What a handler takes and gives: a request whose body is here already, and a response whose body may be
// a string, a file, or a source that is asked for piece after piece.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tin/base/progress.h"

namespace server::http {

enum class Method { kGet, kHead, kPost, kPut, kPatch, kDelete, kOptions };

/// "GET" and so on.
std::string_view method_name(Method method);

/// The method of that exact name (they are case-sensitive), or nothing for one that we do not implement.
std::optional<Method> method_named(std::string_view name);

/// Pairs of name and value, in the order in which they were sent.
using NamedValues = std::vector<std::pair<std::string, std::string>>;

/// Whether anybody still waits for an answer: not when the client has closed its side of the connection, or
/// when the server will not wait any longer. Thread-safe.
class Attention {
 public:
  bool lost() const { return lost_.load(std::memory_order_relaxed); }
  void lose() {
    lost_.store(true, std::memory_order_relaxed);
    const std::lock_guard lock(mutex_);
    if (work_ != nullptr) work_->cancel();
  }

  /// Work that is cancelled when nobody waits for it any more, for as long as this lives.
  class Work {
   public:
    Work(std::shared_ptr<Attention> attention, tin::base::Progress& progress)
        : attention_(std::move(attention)) {
      if (attention_) attention_->watch(&progress);
    }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;
    ~Work() {
      if (attention_) attention_->watch(nullptr);
    }

   private:
    const std::shared_ptr<Attention> attention_;
  };

 private:
  void watch(tin::base::Progress* work) {
    const std::lock_guard lock(mutex_);
    work_ = work;
    if (work_ != nullptr && lost()) work_->cancel();
  }

  std::atomic<bool> lost_{false};
  std::mutex mutex_;
  tin::base::Progress* work_ = nullptr;
};

/// A request that passed the limits, the routing and the check of its query parameters.
struct Request {
  Method method = Method::kGet;  // kHead on a GET route: answer as for GET, the body is dropped
  std::string path;              // percent-decoded
  NamedValues query;             // decoded; each name at most once, and known to the route
  std::map<std::string, std::string, std::less<>> path_parameters;  // by the names in the route's pattern
  NamedValues headers;              // names in lower case; repeated fields joined with ", "
  std::string body;                 // when the route takes it in memory
  std::filesystem::path body_file;  // when the route takes it as a file: gone after the handler returned
  std::string id;                   // the client's X-Request-Id if it is sound, else ours; also the answer's
  std::string client;               // who asks, as far as the gate knows; for the log
  std::shared_ptr<Attention> attention;  // of those who wait for the answer; null: they do

  /// The value of a query parameter, if it was sent.
  std::optional<std::string> query_value(std::string_view name) const;

  /// The value of a header field by its lower-case name; "" if absent.
  std::string_view header(std::string_view lower_name) const;

  /// The value that the path has for `name` in the route's pattern; "" if the pattern has no such name.
  std::string_view path_parameter(std::string_view name) const;

  /// Whether the answer is not waited for any more: long handlers ask now and then, and give up.
  bool is_aborted() const { return attention != nullptr && attention->lost(); }

  /// Hands the uploaded file to the caller, who removes it from now on.
  std::filesystem::path release_body_file();
};

/// A body made piece by piece.
///
/// Threads: next() and the destructor run on worker threads, one call at a time.
class BodySource {
 public:
  virtual ~BodySource() = default;

  /// Puts the next bytes into `piece` (empty on entry) and returns true, or returns false at the end.
  ///
  /// It is called when the client has taken the last piece, so nothing piles up. An empty piece means that
  /// there is nothing yet: the server asks again after ServerOptions::poll_interval and holds no thread
  /// meanwhile (an event stream waits like that, and is ended there when the server drains). Throw on
  /// failure: the connection is then cut, so that the client sees an incomplete answer.
  virtual bool next(std::string& piece) = 0;
};

/// A body that is a file, opened when the handler has returned.
struct FileBody {
  std::filesystem::path path;
  bool remove_after = false;
};

using Body = std::variant<std::string, std::unique_ptr<BodySource>, FileBody>;

/// An answer. The server adds the length, Date, Server, X-Request-Id and the CORS fields, ignores those of
/// the handler, and turns a 200 whose ETag matches the request's If-None-Match into a 304.
struct Response {
  int status = 200;
  NamedValues headers;
  Body body;
};

using Handler = std::function<Response(Request&)>;

/// Answers at once or not at all: it runs on the thread that serves many connections, so it must neither wait
/// nor take more than some microseconds. Nothing: the route's handler is called on a worker instead.
using QuickHandler = std::function<std::optional<Response>(Request&)>;

/// ASCII letters to lower case; every other byte stays.
std::string lower_case(std::string_view text);

}  // namespace server::http
