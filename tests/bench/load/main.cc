// tinsmith-load: what the server does under load, on loopback, with the machine's own load beside it.
//
//   tinsmith-load PROGRAM [edits|batch|elevation|export|hostile]...      all of them by default
//
// TINSMITH_LOAD_SECONDS (3) is how long each line measures.
#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <thread>

#include "tests/bench/load/client.h"
#include "tests/bench/load/hostile.h"
#include "tests/bench/load/nginx.h"
#include "tests/bench/load/server.h"

namespace tests::load {
namespace {

const std::string kConfig =
    R"({"log_level": "error", "limits": {"positions_per_request": 10000000, "body_bytes_memory": 268435456},
        "http": {"requests_per_connection": 1000000000}})";

Clock::duration measure_time() {
  const char* given = std::getenv("TINSMITH_LOAD_SECONDS");
  return std::chrono::milliseconds(given == nullptr ? 3000
                                                    : static_cast<int>(1000 * std::strtod(given, nullptr)));
}

std::string machine_load() {
  std::ifstream in("/proc/loadavg");
  std::string one, five;
  in >> one >> five;
  return one;
}

void print(const char* what, const LoadResult& r, double per_answer, const char* unit) {
  std::printf("%-44s %12.0f %-12s p50 %8.2f ms  p99 %8.2f ms", what, r.per_second() * per_answer, unit,
              r.percentile_ms(50), r.percentile_ms(99));
  if (r.failures > 0) std::printf("  %llu FAILED", static_cast<unsigned long long>(r.failures));
  std::printf("\n");
  std::fflush(stdout);
}

std::string coordinates(std::uint64_t n) {
  // A walk that fills the square evenly (Weyl's sequence), so that inserts fall anywhere.
  const auto part = [](double v) {
    return 10'000 * (v - static_cast<double>(static_cast<std::uint64_t>(v)));
  };
  char text[64];
  std::snprintf(text, sizeof text, R"("x":%.3f,"y":%.3f)", part(static_cast<double>(n) * 0.7548776662466927),
                part(static_cast<double>(n) * 0.5698402909980532));
  return text;
}

std::string insert_op(std::uint64_t n) {
  return R"({"op":"insert",)" + coordinates(n) + R"(,"z":7.5})";
}

/// Commits a second of one row each, by SQLite alone as the server uses it.
double sqlite_commits_per_second(Clock::duration time) {
  const support::TempDir folder;
  sqlite3* database = nullptr;
  sqlite3_open((folder.path() / "commits.sqlite").c_str(), &database);
  sqlite3_exec(
      database,
      "PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; CREATE TABLE t(id INTEGER PRIMARY KEY, b BLOB);",
      nullptr, nullptr, nullptr);
  const auto begin = Clock::now();
  int commits = 0;
  for (; Clock::now() - begin < time; ++commits) {
    sqlite3_exec(database, "INSERT INTO t(b) VALUES(zeroblob(96))", nullptr, nullptr, nullptr);
  }
  sqlite3_close(database);
  return commits / std::chrono::duration<double>(Clock::now() - begin).count();
}

void edits(const std::string& program) {
  std::printf("sqlite alone: %.0f commits/s (WAL, synchronous=FULL, one row each)\n",
              sqlite_commits_per_second(measure_time()));
  const Server server(program, kConfig);
  server.make_tin("t", 100'000);
  std::atomic<std::uint64_t> next{0};
  for (const int clients : {1, 16, 64}) {
    const LoadResult r = run({server.port(), clients, measure_time()}, [&](int, std::uint64_t) {
      return post("/tins/t/edits", "application/json", R"({"ops":[)" + insert_op(++next) + "]}");
    });
    print(("single edits, " + std::to_string(clients) + " clients").c_str(), r, 1, "edits/s");
  }
}

void batch(const std::string& program) {
  constexpr int kBatch = 10'000;
  const Server server(program, kConfig);
  server.make_tin("t", 100'000);
  std::atomic<std::uint64_t> next{0};
  for (const int clients : {1, 4}) {
    const LoadResult r = run({server.port(), clients, measure_time()}, [&](int, std::uint64_t) {
      std::string ops;
      for (int i = 0; i < kBatch; ++i) ops += (i == 0 ? "" : ",") + insert_op(++next);
      return post("/tins/t/edits", "application/json", R"({"ops":[)" + ops + "]}");
    });
    print(("edits of 10,000 vertices, " + std::to_string(clients) + " clients").c_str(), r, kBatch,
          "vertices/s");
  }
}

std::string json_positions(int count, std::uint64_t first) {
  std::string list;
  char text[48];
  for (int i = 0; i < count; ++i) {
    const std::uint64_t n = (first + static_cast<unsigned>(i)) * 2654435761U;
    std::snprintf(text, sizeof text, "%s[%.2f,%.2f]", i == 0 ? "" : ",",
                  static_cast<double>(n % 1'000'000) / 100,
                  static_cast<double>(n / 1'000'000 % 1'000'000) / 100);
    list += text;
  }
  return R"({"positions":[)" + list + "]}";
}

std::string binary_positions(int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) {
    for (const unsigned step : {2654435761U, 40503U}) {
      const double v = static_cast<double>(static_cast<std::uint64_t>(i) * step % 1'000'000) / 100;
      bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
    }
  }
  return bytes;
}

/// Another client that edits all the time, until the end of the scope.
class Editor {
 public:
  explicit Editor(std::uint16_t port)
      : thread_([this, port] {
          std::uint64_t n = 1'000'000'000;
          while (!over_) {
            const LoadResult r = run({port, 1, std::chrono::milliseconds(200)}, [&](int, std::uint64_t) {
              return post("/tins/t/edits", "application/json", R"({"ops":[)" + insert_op(++n) + "]}");
            });
            edits_ += r.answers;
          }
        }) {}
  ~Editor() { over_ = true; }
  std::uint64_t edits() const { return edits_; }

 private:
  std::atomic<bool> over_{false};
  std::atomic<std::uint64_t> edits_{0};
  std::jthread thread_;
};

void elevation_lines(std::uint16_t port, const std::string& suffix) {
  constexpr int kJsonBatch = 10'000, kBinaryBatch = 100'000;
  const LoadResult single = run({port, 64, measure_time()}, [](int client, std::uint64_t n) {
    const auto place = [&](std::uint64_t step) {
      return std::to_string((n * step + static_cast<unsigned>(client) * 31U) % 10'000) + ".5";
    };
    return get("/tins/t/elevation?x=" + place(7919) + "&y=" + place(104729));
  });
  print(("single elevations, 64 clients" + suffix).c_str(), single, 1, "positions/s");
  const std::string json = post("/tins/t/elevation", "application/json", json_positions(kJsonBatch, 1));
  const LoadResult many = run({port, 4, measure_time()}, [&](int, std::uint64_t) { return json; });
  print(("10,000 elevations as JSON, 4 clients" + suffix).c_str(), many, kJsonBatch, "positions/s");
  const std::string binary =
      post("/tins/t/elevation", "application/octet-stream", binary_positions(kBinaryBatch));
  const LoadResult bytes = run({port, 4, measure_time()}, [&](int, std::uint64_t) { return binary; });
  print(("100,000 elevations as doubles, 4 clients" + suffix).c_str(), bytes, kBinaryBatch, "positions/s");
}

void elevation(const std::string& program) {
  const Server server(program, kConfig);
  server.make_tin("t", 100'000);
  if (const auto peer = Nginx::start()) {
    const LoadResult r = run({peer->port(), 64, measure_time()}, [](int, std::uint64_t) { return get("/"); });
    print("nginx, one worker, a constant body, 64 clients", r, 1, "answers/s");
  } else {
    std::printf("nginx is not installed: no peer\n");
  }
  elevation_lines(server.port(), "");
  Editor editor(server.port());
  elevation_lines(server.port(), ", an editor beside");
  std::printf("%-44s %12llu edits meanwhile\n", "", static_cast<unsigned long long>(editor.edits()));
}

void export_line(const std::string& program) {
  const Server server(program, kConfig);
  server.make_tin("t", 2'000'000);
  std::uint64_t n = 0;
  const auto edit = [&](int, std::uint64_t) {
    return post("/tins/t/edits", "application/json", R"({"ops":[)" + insert_op(++n) + "]}");
  };
  print("2M vertices: single edits, 1 client", run({server.port(), 1, measure_time()}, edit), 1, "edits/s");
  std::atomic<bool> over{false};
  std::atomic<std::uint64_t> taken{0};
  std::jthread reader([&] {
    Crowd slow(server.port(), 1, get("/tins/t/export?f=geojson"), 64 * 1024);
    while (!over) {  // about 2 MB/s
      taken += slow.read_each(20'000);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const LoadResult r = run({server.port(), 1, 2 * measure_time()}, edit);
  over = true;
  print("2M vertices: the same while one exports slowly", r, 1, "edits/s");
  std::printf("%-44s %12.1f MB taken meanwhile; the slowest edit %.1f ms\n", "",
              static_cast<double>(taken) / 1e6, r.percentile_ms(100));
}

void hostile(const std::string& program) {
  const Server server(program, hostile_config());
  server.make_tin("t", 100'000);
  HostileSizes sizes;
  sizes.time = measure_time();
  double alone = 0;
  for (const HostileResult& r : run_hostile(server.port(), sizes, [&] { return server.resident_bytes(); })) {
    const double p99 = r.others.percentile_ms(99);
    if (alone == 0) alone = p99;
    print(r.name.c_str(), r.others, 1, "answers/s");
    std::printf("%-44s %12.2f times the p99; %.0f MB\n", "", p99 / alone,
                static_cast<double>(r.resident_bytes) / 1e6);
  }
}

int run_all(int argc, char** argv) {
  const std::map<std::string, void (*)(const std::string&)> parts{{"edits", edits},
                                                                  {"batch", batch},
                                                                  {"elevation", elevation},
                                                                  {"export", export_line},
                                                                  {"hostile", hostile}};
  if (argc < 2) {
    std::fprintf(stderr, "usage: tinsmith-load PROGRAM [edits|batch|elevation|export|hostile]...\n");
    return 2;
  }
  std::vector<std::string> wanted(argv + 2, argv + argc);
  if (wanted.empty()) wanted = {"edits", "batch", "elevation", "export", "hostile"};
  raise_descriptors();
  for (const std::string& name : wanted) {
    const auto part = parts.find(name);
    if (part == parts.end()) {
      std::fprintf(stderr, "there is no part \"%s\"\n", name.c_str());
      return 2;
    }
    std::printf("-- %s (%u cores, load %s)\n", name.c_str(), std::thread::hardware_concurrency(),
                machine_load().c_str());
    part->second(argv[1]);
  }
  return 0;
}

}  // namespace
}  // namespace tests::load

int main(int argc, char** argv) {
  try {
    return tests::load::run_all(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "tinsmith-load: %s\n", e.what());
    return 1;
  }
}
