// Many clients of one server from one thread: each keeps a connection, asks, waits for the whole answer, asks
// again. And clients who mean no good.
//
//   Load load{port, 64, std::chrono::seconds(3)};
//   const LoadResult r = run(load, [](int client, std::uint64_t n) { return request_bytes(...); });
//   r.per_second(); r.percentile_ms(99);
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tests::load {

using Clock = std::chrono::steady_clock;

struct Load {
  std::uint16_t port = 0;
  int clients = 1;
  Clock::duration time = std::chrono::seconds(3);
};

struct LoadResult {
  std::uint64_t answers = 0;   // 2xx
  std::uint64_t failures = 0;  // other answers, and connections that broke
  double seconds = 0;
  std::vector<double> latencies_ms;  // of the answers

  double per_second() const { return static_cast<double>(answers) / seconds; }
  /// p in 0..100; 0 if there was no answer.
  double percentile_ms(double p) const;
};

/// Makes the bytes of a client's n-th request.
using MakeRequest = std::function<std::string(int client, std::uint64_t n)>;

/// Runs until the time is over; a connection that the server closes is opened again. Throws when it cannot
/// connect.
LoadResult run(const Load& load, const MakeRequest& make);

/// A request with Connection: keep-alive.
std::string get(const std::string& target);
std::string post(const std::string& target, const std::string& content_type, const std::string& body);

/// Open connections that do nothing but what `act` does with them now and then, until the end of the scope.
class Crowd {
 public:
  /// Connects `count` clients; each sends `first`. `receive_buffer` > 0 makes them small.
  Crowd(std::uint16_t port, int count, const std::string& first, int receive_buffer = 0);
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  /// Sends `bytes` on each; those that the server closed are left alone.
  void send_each(const std::string& bytes);
  /// Reads up to `bytes` from each. Returns how many came.
  std::uint64_t read_each(std::size_t bytes);
  /// How many the server has not closed.
  int open() const;
  int count() const { return static_cast<int>(sockets_.size()); }

 private:
  std::vector<int> sockets_;
};

/// Lets this process, and the children to come, have as many descriptors as the system allows. Returns how
/// many.
std::uint64_t raise_descriptors();

}  // namespace tests::load
