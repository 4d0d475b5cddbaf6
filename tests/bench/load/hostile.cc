#include "tests/bench/load/hostile.h"

#include <atomic>
#include <memory>
#include <thread>

namespace tests::load {
namespace {

constexpr int kGoodClients = 8;
constexpr int kSmallBuffer = 4096;

LoadResult good_clients(std::uint16_t port, Clock::duration time) {
  return run({port, kGoodClients, time}, [](int client, std::uint64_t n) {
    const auto place = [&](std::uint64_t step) {
      return std::to_string((n * step + static_cast<unsigned>(client)) % 10'000);
    };
    return get("/tins/t/elevation?x=" + place(7919) + "&y=" + place(104729));
  });
}

/// Good clients while a crowd does what `act` makes it do, ten times a second.
LoadResult beside(std::uint16_t port, Clock::duration time, Crowd& crowd,
                  const std::function<void(Crowd&)>& act) {
  std::atomic<bool> over{false};
  std::jthread bad([&] {
    while (!over && act) {
      act(crowd);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  LoadResult result = good_clients(port, time);
  over = true;
  return result;
}

}  // namespace

std::string hostile_config() {
  return R"({"log_level": "error",
             "http": {"connections": 20000, "connections_per_address": 20000, "requests_per_connection": 1000000000}})";
}

std::vector<HostileResult> run_hostile(std::uint16_t port, const HostileSizes& sizes,
                                       const std::function<std::uint64_t()>& resident) {
  std::vector<HostileResult> results;
  const auto add = [&](const std::string& name, LoadResult others) {
    results.push_back({name, std::move(others), resident()});
  };
  good_clients(port, sizes.time / 4);  // warm
  add("nobody else", good_clients(port, sizes.time));
  {
    Crowd crowd(port, sizes.idle, "");
    add(std::to_string(sizes.idle) + " idle connections", beside(port, sizes.time, crowd, {}));
  }
  {
    Crowd crowd(port, sizes.slow_heads, "GET /tins HTTP/1.1\r\nHost: t\r\n");
    add(std::to_string(sizes.slow_heads) + " slow heads",
        beside(port, sizes.time, crowd, [](Crowd& c) { c.send_each("X: y\r\n"); }));
  }
  {
    Crowd crowd(port, sizes.slow_bodies,
                "POST /tins/t/edits HTTP/1.1\r\nHost: t\r\nContent-Type: application/json\r\n"
                "Content-Length: 1000000\r\n\r\n{");
    add(std::to_string(sizes.slow_bodies) + " slow bodies",
        beside(port, sizes.time, crowd, [](Crowd& c) { c.send_each(" "); }));
  }
  {
    Crowd crowd(port, sizes.slow_readers, get("/tins/t/export?f=geojson"), kSmallBuffer);
    add(std::to_string(sizes.slow_readers) + " slow readers",
        beside(port, sizes.time, crowd, [](Crowd& c) { c.read_each(100); }));
  }
  return results;
}

}  // namespace tests::load
