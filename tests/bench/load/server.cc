#include "tests/bench/load/server.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <stdexcept>

namespace tests::load {

Server::Server(const std::string& program, const std::string& config) {
  const auto file = folder_.path() / "config.json";
  std::ofstream(file) << config;
  child_ = std::make_unique<support::Child>(
      std::vector<std::string>{program, "serve", "--listen", "127.0.0.1:0", "--data",
                               (folder_.path() / "data").string(), "--config", file.string()},
      folder_.path() / "log");
  const std::string line = child_->read_line();
  const std::size_t colon = line.rfind(':');
  if (line.find("http://127.0.0.1:") == std::string::npos) throw std::runtime_error("no server: " + line);
  port_ = static_cast<std::uint16_t>(std::stoi(line.substr(colon + 1)));
}

Server::~Server() {
  child_->signal(SIGTERM);
  child_->wait();
}

std::uint64_t Server::resident_bytes() const {
  return static_cast<std::uint64_t>(metric(http(), "process_resident_memory_bytes"));
}

void Server::make_tin(const std::string& id, int count) const {
  std::mt19937_64 random(20021128);
  std::string text = "x,y,z\n";
  char line[80];
  for (int i = 0; i < count; ++i) {
    const auto milli = [&] { return static_cast<double>(random() % 10'000'000) / 1000; };
    const double x = milli(), y = milli();
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.2f\n", x, y, milli() / 10);
    text += line;
  }
  const auto answer = http().post("/tins?id=" + id, "text/csv", text);
  if (answer.status != 201) throw std::runtime_error("no TIN: " + answer.body);
}

double metric(const support::HttpClient& http, std::string_view name) {
  const std::string text = http.get("/metrics").body;
  const std::size_t at = text.find("\n" + std::string(name) + " ");
  if (at == std::string::npos) throw std::runtime_error("no metric " + std::string(name));
  return std::strtod(text.c_str() + at + 1 + name.size(), nullptr);
}

}  // namespace tests::load
