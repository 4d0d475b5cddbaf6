// The peer: nginx with one worker that answers everything with one short body.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace tests::load {

class Nginx {
 public:
  /// Nothing where nginx is not installed or does not start.
  static std::unique_ptr<Nginx> start();
  ~Nginx();

  std::uint16_t port() const { return port_; }

 private:
  Nginx() = default;
  support::TempDir folder_;
  std::unique_ptr<support::Child> child_;
  std::uint16_t port_ = 0;
};

}  // namespace tests::load
