// The program under load: started on a port and a folder of its own, with a configuration.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "tests/support/http_client.h"
#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace tests::load {

class Server {
 public:
  /// `program` is the path of tinsmith, `config` JSON. The log goes to a file and holds errors only.
  Server(const std::string& program, const std::string& config);
  ~Server();

  std::uint16_t port() const { return port_; }
  support::HttpClient http() const { return support::HttpClient(port_); }
  /// Bytes in RAM.
  std::uint64_t resident_bytes() const;
  /// Makes a TIN of `count` random vertices in a square of 10 km, uploaded as text. Throws if that fails.
  void make_tin(const std::string& id, int count) const;

 private:
  support::TempDir folder_;
  std::unique_ptr<support::Child> child_;
  std::uint16_t port_ = 0;
};

/// The number of a sample of /metrics.
double metric(const support::HttpClient& http, std::string_view name);

}  // namespace tests::load
