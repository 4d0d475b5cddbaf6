// An HTTP client for tests: one connection for each request, on plain sockets.
//
//   HttpClient http(port);
//   const RawAnswer answer = http.post("/tins", "application/json", R"({"id":"hill"})");
//   EXPECT_EQ(answer.status, 201);
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/support/raw_http.h"

namespace tests::support {

/// What is asked for. A content type of "" sends none; `fields` are whole lines, each ended by "\r\n".
struct Ask {
  std::string method = "GET";
  std::string target = "/";
  std::string content_type = {};
  std::string body = {};
  std::string fields = {};
};

inline std::string request_bytes(const Ask& ask) {
  std::string bytes =
      ask.method + " " + ask.target + " HTTP/1.1\r\nHost: test\r\nConnection: close\r\n" + ask.fields;
  if (!ask.content_type.empty()) bytes += "Content-Type: " + ask.content_type + "\r\n";
  if (!ask.body.empty() || ask.method == "POST")
    bytes += "Content-Length: " + std::to_string(ask.body.size()) + "\r\n";
  return bytes + "\r\n" + ask.body;
}

/// Threads: any number.
class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port) : port_(port) {}

  RawAnswer send(const Ask& ask) const {
    constexpr int kPatienceSeconds = 180;  // sanitizers make long work longer
    RawClient client(port_, 0, kPatienceSeconds);
    client.send(request_bytes(ask));
    return client.read_answer(ask.method == "HEAD");
  }
  RawAnswer get(std::string target, std::string fields = {}) const {
    return send({"GET", std::move(target), {}, {}, std::move(fields)});
  }
  RawAnswer post(std::string target, std::string content_type, std::string body,
                 std::string fields = {}) const {
    return send({"POST", std::move(target), std::move(content_type), std::move(body), std::move(fields)});
  }
  RawAnswer post_json(std::string target, std::string body, std::string fields = {}) const {
    return post(std::move(target), "application/json", std::move(body), std::move(fields));
  }
  RawAnswer remove(std::string target) const { return send({"DELETE", std::move(target)}); }

  std::uint16_t port() const { return port_; }

 private:
  std::uint16_t port_;
};

}  // namespace tests::support
