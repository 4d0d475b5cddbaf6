// A server on a free port of the loopback interface, with a few routes that do what the tests need.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/http/server.h"
#include "tests/support/raw_http.h"

namespace tests::server_http {

using server::http::Access;
using server::http::BodyKind;
using server::http::BodySource;
using server::http::FileBody;
using server::http::Method;
using server::http::Request;
using server::http::Response;
using server::http::Route;
using server::http::Router;
using server::http::Server;
using server::http::ServerOptions;
using tests::support::RawAnswer;
using tests::support::RawClient;

/// A gate at which handlers wait until the test opens it.
class Gate {
 public:
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_; });
  }
  void wait_for_visitor() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_ > 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int waiting_ = 0;
};

/// A source from a function: it gets the number of the piece.
class LambdaSource : public BodySource {
 public:
  explicit LambdaSource(std::function<bool(int, std::string&)> make) : make_(std::move(make)) {}
  bool next(std::string& piece) override { return make_(count_++, piece); }

 private:
  std::function<bool(int, std::string&)> make_;
  int count_ = 0;
};

inline Response streaming(std::function<bool(int, std::string&)> make) {
  Response response;
  response.body = std::make_unique<LambdaSource>(std::move(make));
  return response;
}

inline Response text(std::string body) {
  return Response{200, {{"Content-Type", "text/plain"}}, std::move(body)};
}

/// A chunk of a chunked body.
inline std::string chunk(const std::string& data) {
  char size[20];
  std::snprintf(size, sizeof size, "%zx\r\n", data.size());
  return size + data + "\r\n";
}

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

class HttpTest : public testing::Test {
 protected:
  HttpTest() {
    options_.upload_dir = std::filesystem::path(testing::TempDir()) /
                          ("http-" + std::to_string(::getpid()) + "-" +
                           testing::UnitTest::GetInstance()->current_test_info()->name());
    add(Method::kGet, "/hello", [](Request&) { return text("hello"); });
    add(Method::kGet, "/throw", [](Request&) -> Response { throw std::runtime_error("secret detail"); });
    add(
        Method::kPost, "/echo", [](Request& r) { return text(r.body); }, BodyKind::kMemory);
    add(
        Method::kPost, "/upload", [](Request& r) { return text(read_file(r.body_file)); }, BodyKind::kFile);
  }

  ~HttpTest() override {
    gate_.open();
    server_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(options_.upload_dir, ignored);
  }

  void add(Method method, std::string pattern, server::http::Handler handler,
           BodyKind body = BodyKind::kNone) {
    router_.add({.method = method,
                 .pattern = std::move(pattern),
                 .query = {"limit", "crs"},
                 .body = body,
                 .body_limit = 0,
                 .handler = std::move(handler)});
  }

  std::uint16_t start() {
    server_ = std::make_unique<Server>(options_, router_, pages(), observer());
    auto port = server_->start();
    EXPECT_TRUE(port) << port.error().message;
    return port_ = port.value();
  }

  static server::http::ErrorPages pages() {
    return {
        [](const tin::base::Error& e) {
          const int status = e.code == tin::base::Code::kNotFound   ? 404
                             : e.code == tin::base::Code::kTooLarge ? 413
                             : e.code == tin::base::Code::kStorage  ? 507
                                                                    : 400;
          return Response{status, {{"Content-Type", "application/problem+json"}}, e.where + " " + e.message};
        },
        [](int status, const std::string& detail) {
          return Response{status, {{"Content-Type", "application/problem+json"}}, detail};
        }};
  }

  server::http::Observer observer() {
    return {[this](const Access& access) {
              const std::lock_guard lock(mutex_);
              accesses_.push_back(access);
            },
            [this](const std::string& id, const std::string& what) {
              const std::lock_guard lock(mutex_);
              problems_.emplace_back(id, what);
            }};
  }

  std::vector<std::pair<std::string, std::string>> problems() {
    const std::lock_guard lock(mutex_);
    return problems_;
  }

  std::vector<Access> accesses() {
    const std::lock_guard lock(mutex_);
    return accesses_;
  }

  /// A request on a connection of its own.
  RawAnswer ask(const std::string& request_line, const std::string& fields = "",
                const std::string& body = "") {
    RawClient client(port_);
    client.send(request_line + " HTTP/1.1\r\nHost: t\r\n" + fields + "\r\n" + body);
    return client.read_answer(request_line.starts_with("HEAD "));
  }

  ServerOptions options_;
  Router router_;
  Gate gate_;
  std::uint16_t port_ = 0;
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> problems_;
  std::vector<Access> accesses_;
  std::unique_ptr<Server> server_;
};

}  // namespace tests::server_http
