// A client of plain blocking sockets that sends exactly the bytes a test gives it, and reads what comes back.
//
//   RawClient client(port);
//   client.send("GET /a HTTP/1.1\r\nHost: x\r\n\r\n");
//   const RawAnswer answer = client.read_answer();
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace tests::support {

/// An answer as it came. `status` is 0 when the connection ended before a whole head was there.
struct RawAnswer {
  int status = 0;
  std::multimap<std::string, std::string> headers;  // lower-case names
  std::string body;                                 // chunks put together
  bool complete = false;                            // the body ended as its framing promised

  std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? std::string() : found->second;
  }
};

class RawClient {
 public:
  explicit RawClient(std::uint16_t port, int receive_buffer = 0, int patience_seconds = 20)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (socket_ < 0) throw std::runtime_error("no socket");
    if (receive_buffer > 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    timeval limit{patience_seconds, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      ::close(socket_);
      throw std::runtime_error("cannot connect");
    }
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() { ::close(socket_); }

  /// Sends all of it; returns false if the server closed meanwhile.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// Reads one answer. `head_only`: it is for a HEAD request.
  RawAnswer read_answer(bool head_only = false) {
    RawAnswer answer;
    std::size_t end = 0;
    while ((end = in_.find("\r\n\r\n")) == std::string::npos) {
      if (!read_more()) return answer;
    }
    const std::string head = in_.substr(0, end + 2);
    in_.erase(0, end + 4);
    parse_head(head, answer);
    const bool bodiless =
        head_only || answer.status == 204 || answer.status == 304 || answer.status / 100 == 1;
    answer.complete = bodiless || read_body(answer);
    return answer;
  }

  /// Sends a request and reads its answer.
  RawAnswer ask(std::string_view request) {
    send(request);
    return read_answer();
  }

  /// Everything until the server closes; `reset` tells whether it did so by a reset.
  std::string read_to_end(bool* reset = nullptr) {
    while (read_more()) {
    }
    if (reset != nullptr) *reset = last_error_ == ECONNRESET;
    return std::exchange(in_, {});
  }

  /// What has arrived, or what arrives next; "" when nothing does any more.
  std::string read_some() {
    if (in_.empty()) read_more();
    return std::exchange(in_, {});
  }

  /// Whether the server has closed (or closes within the receive timeout) without sending more.
  bool closed() { return in_.empty() && !read_more() && last_error_ != EAGAIN; }

  /// Ends the sending side.
  void finish_sending() { ::shutdown(socket_, SHUT_WR); }

 private:
  bool read_more() {
    char block[16384];
    const ssize_t got = ::recv(socket_, block, sizeof block, 0);
    last_error_ = got < 0 ? errno : 0;
    if (got <= 0) return false;
    in_.append(block, static_cast<std::size_t>(got));
    return true;
  }

  static void parse_head(std::string_view head, RawAnswer& answer) {
    if (head.size() > 12) answer.status = std::atoi(std::string(head.substr(9, 3)).c_str());
    head.remove_prefix(head.find("\r\n") + 2);
    while (!head.empty()) {
      const std::size_t end = head.find("\r\n");
      const std::string_view line = head.substr(0, end);
      const std::size_t colon = line.find(": ");
      std::string name(line.substr(0, colon));
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      answer.headers.emplace(name, line.substr(colon + 2));
      head.remove_prefix(end + 2);
    }
  }

  bool take(std::size_t size, std::string& to) {
    while (in_.size() < size) {
      if (!read_more()) return false;
    }
    to.append(in_, 0, size);
    in_.erase(0, size);
    return true;
  }

  bool read_body(RawAnswer& answer) {
    if (answer.header("transfer-encoding") == "chunked") return read_chunks(answer);
    if (const std::string length = answer.header("content-length"); !length.empty()) {
      return take(std::strtoull(length.c_str(), nullptr, 10), answer.body);
    }
    bool reset = false;
    answer.body = read_to_end(&reset);
    return !reset;
  }

  bool read_chunks(RawAnswer& answer) {
    while (true) {
      std::size_t end = 0;
      while ((end = in_.find("\r\n")) == std::string::npos) {
        if (!read_more()) return false;
      }
      const std::size_t size = std::strtoull(in_.c_str(), nullptr, 16);
      in_.erase(0, end + 2);
      std::string crlf;
      if (!take(size, answer.body) || !take(2, crlf)) return false;
      if (size == 0) return true;
    }
  }

  int socket_;
  int last_error_ = 0;
  std::string in_;
};

}  // namespace tests::support
