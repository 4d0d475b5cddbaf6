#include "tests/bench/load/client.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace tests::load {
namespace {

int connect_to(std::uint16_t port, int receive_buffer = 0) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) throw std::runtime_error("no socket: too few descriptors?");
  if (receive_buffer > 0) ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket);
    throw std::runtime_error("cannot connect");
  }
  ::fcntl(socket, F_SETFL, O_NONBLOCK);
  return socket;
}

/// One client: its connection, the request that it sends, and the answer so far.
class Client {
 public:
  Client(std::uint16_t port, int number) : port_(port), number_(number) {}
  ~Client() { drop(); }
  Client(Client&& other) noexcept
      : port_(other.port_), number_(other.number_), socket_(std::exchange(other.socket_, -1)) {}
  Client& operator=(Client&&) = delete;

  void begin(int epoll, const MakeRequest& make) {
    if (socket_ < 0) {
      socket_ = connect_to(port_);
      epoll_event event{};
      event.events = EPOLLIN;
      event.data.u32 = static_cast<std::uint32_t>(number_);
      ::epoll_ctl(epoll, EPOLL_CTL_ADD, socket_, &event);
    }
    request_ = make(number_, requests_++);
    sent_ = 0;
    answer_.clear();
    end_ = 0;
    start_ = Clock::now();
    push(epoll);
  }

  /// Sends what the socket takes; asks to be told when it takes more.
  void push(int epoll) {
    while (sent_ < request_.size()) {
      const ssize_t sent = ::send(socket_, request_.data() + sent_, request_.size() - sent_, MSG_NOSIGNAL);
      if (sent <= 0) break;
      sent_ += static_cast<std::size_t>(sent);
    }
    const bool wants = sent_ < request_.size();
    if (wants == waits_to_send_) return;
    waits_to_send_ = wants;
    epoll_event event{};
    event.events = wants ? EPOLLIN | EPOLLOUT : EPOLLIN;
    event.data.u32 = static_cast<std::uint32_t>(number_);
    ::epoll_ctl(epoll, EPOLL_CTL_MOD, socket_, &event);
  }

  enum class Got { kMore, kWhole, kClosed };

  Got pull() {
    static thread_local std::array<char, 256 * 1024> block;
    const ssize_t got = ::recv(socket_, block.data(), block.size(), 0);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return Got::kMore;
    if (got <= 0) {
      drop();
      return Got::kClosed;
    }
    answer_.append(block.data(), static_cast<std::size_t>(got));
    if (end_ == 0) measure();
    return end_ != 0 && answer_.size() >= end_ ? Got::kWhole : Got::kMore;
  }

  bool fine() const { return answer_.size() > 12 && answer_[9] == '2'; }
  double waited_ms() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

  /// After an answer that was the connection's last.
  void drop_if_last() {
    if (answer_.find("Connection: close") < answer_.find("\r\n\r\n")) drop();
  }

 private:
  /// Finds where the answer ends: it must have a length.
  void measure() {
    const std::size_t head = answer_.find("\r\n\r\n");
    if (head == std::string::npos) return;
    const std::size_t field = answer_.find("Content-Length: ");
    if (field > head) throw std::runtime_error("an answer without a length: " + answer_.substr(0, head));
    end_ = head + 4 + std::strtoull(answer_.c_str() + field + 16, nullptr, 10);
  }

  void drop() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    waits_to_send_ = false;
  }

  std::uint16_t port_;
  int number_;
  int socket_ = -1;
  std::uint64_t requests_ = 0;
  std::string request_, answer_;
  std::size_t sent_ = 0, end_ = 0;
  bool waits_to_send_ = false;
  Clock::time_point start_;
};

}  // namespace

double LoadResult::percentile_ms(double p) const {
  if (latencies_ms.empty()) return 0;
  std::vector<double> sorted = latencies_ms;
  const double rank = std::ceil(p / 100 * static_cast<double>(sorted.size()));
  const std::size_t index = std::min(sorted.size() - 1, static_cast<std::size_t>(std::max(rank, 1.0)) - 1);
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(index), sorted.end());
  return sorted[index];
}

LoadResult run(const Load& load, const MakeRequest& make) {
  LoadResult result;
  const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
  std::vector<Client> clients;
  clients.reserve(static_cast<std::size_t>(load.clients));
  for (int i = 0; i < load.clients; ++i) clients.emplace_back(load.port, i);
  const auto begin = Clock::now();
  for (Client& client : clients) client.begin(epoll, make);
  std::array<epoll_event, 256> events{};
  while (Clock::now() - begin < load.time) {
    const int count = ::epoll_wait(epoll, events.data(), static_cast<int>(events.size()), 100);
    for (int i = 0; i < count; ++i) {
      const epoll_event& event = events[static_cast<std::size_t>(i)];
      Client& client = clients[event.data.u32];
      if ((event.events & EPOLLOUT) != 0) client.push(epoll);
      if ((event.events & ~static_cast<std::uint32_t>(EPOLLOUT)) == 0) continue;
      const Client::Got got = client.pull();
      if (got == Client::Got::kMore) continue;
      const bool answered = got == Client::Got::kWhole && client.fine();
      if (answered) result.latencies_ms.push_back(client.waited_ms());
      ++(answered ? result.answers : result.failures);
      if (got == Client::Got::kWhole) client.drop_if_last();
      client.begin(epoll, make);
    }
  }
  result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  ::close(epoll);
  return result;
}

std::string get(const std::string& target) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
}

std::string post(const std::string& target, const std::string& content_type, const std::string& body) {
  return "POST " + target + " HTTP/1.1\r\nHost: localhost\r\nContent-Type: " + content_type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

Crowd::Crowd(std::uint16_t port, int count, const std::string& first, int receive_buffer) {
  for (int i = 0; i < count; ++i) sockets_.push_back(connect_to(port, receive_buffer));
  send_each(first);
}

Crowd::~Crowd() {
  for (const int socket : sockets_) ::close(socket);
}

void Crowd::send_each(const std::string& bytes) {
  if (bytes.empty()) return;
  for (const int socket : sockets_)
    static_cast<void>(::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

std::uint64_t Crowd::read_each(std::size_t bytes) {
  std::string block(bytes, '\0');
  std::uint64_t total = 0;
  for (const int socket : sockets_) {
    const ssize_t got = ::recv(socket, block.data(), block.size(), 0);
    if (got > 0) total += static_cast<std::uint64_t>(got);
  }
  return total;
}

int Crowd::open() const {
  return static_cast<int>(std::count_if(sockets_.begin(), sockets_.end(), [](int socket) {
    char byte = 0;
    const ssize_t got = ::recv(socket, &byte, 1, MSG_PEEK);
    return got > 0 || (got < 0 && errno == EAGAIN);
  }));
}

std::uint64_t raise_descriptors() {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
  return limit.rlim_cur;
}

}  // namespace tests::load
