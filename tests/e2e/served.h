// The program as a process that serves, and its client.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/http_client.h"
#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace tests::e2e {

using support::RawAnswer;
using Json = nlohmann::json;

/// tinsmith serve --listen 127.0.0.1:0 --data FOLDER, from its first line on.
class Served {
 public:
  explicit Served(const std::filesystem::path& data, const std::vector<std::string>& more = {});

  support::HttpClient http() const { return support::HttpClient(port_); }
  const std::string& first_line() const { return line_; }
  /// SIGTERM; the exit status.
  int stop();
  /// SIGKILL.
  void kill();

  RawAnswer upload(const std::string& query, const std::filesystem::path& file,
                   const std::string& fields = {}) const;
  /// The JSON of a 200.
  Json get(const std::string& target) const;
  /// The answer of POST /tins/{tin}/edits, which must be 200.
  Json edit(const std::string& tin, const Json& ops) const;
  /// The results of a simplification, which must be 200.
  Json simplify(const Json& inputs) const;
  /// What became of a job, when it is over.
  Json finished_job(const std::string& job) const;

 private:
  std::filesystem::path err_file_;
  std::unique_ptr<support::Child> child_;
  std::string line_;
  std::uint16_t port_ = 0;
};

/// A test with a folder, and a server on it.
class ServedTest : public testing::Test {
 protected:
  void start(const std::vector<std::string>& more = {}) { served_ = std::make_unique<Served>(data(), more); }
  std::filesystem::path data() const { return folder_.path() / "data"; }
  /// Saves an answer's body; the file's name.
  std::string save(const RawAnswer& answer, const std::string& name) const;

  support::TempDir folder_;
  std::unique_ptr<Served> served_;
};

}  // namespace tests::e2e
