// The whole server in this process, on a port and a folder of its own; every answer is held against the
// contract.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "server/api/routes.h"
#include "server/http/server.h"
#include "tests/contract/contract.h"
#include "tests/support/temp_dir.h"

namespace tests::contract {

using Json = nlohmann::json;

class TestServer {
 public:
  explicit TestServer(const std::function<void(server::Config&)>& adjust = {});
  ~TestServer();

  /// Sends a request and fails the test if the answer breaks the contract.
  RawAnswer ask(const Ask& ask);
  RawAnswer get(std::string target, std::string fields = {});
  RawAnswer post_json(std::string target, std::string body, std::string fields = {});
  RawAnswer upload(std::string target, std::string content_type, std::string body, std::string fields = {});
  RawAnswer remove(std::string target);

  /// The list of TINs as it is served: ids, revisions, digests.
  std::string state();
  /// The document of a TIN.
  Json tin(const std::string& id);
  /// What became of a job ("/jobs/x"), as soon as that is known.
  std::string finished(const std::string& job);
  /// Brings the checkpoint of a TIN forward and forgets its revisions.
  void forget_history(const std::string& id);
  /// The names of files that uploads and exports left behind: none, as soon as the server has tidied up after
  /// its last answer.
  std::set<std::string> leftovers() const;

  /// Occupies the only worker for jobs until the result is let go.
  class Occupation {
   public:
    explicit Occupation(server::jobs::JobQueue& jobs);
    ~Occupation();

   private:
    std::promise<void> let_go_;
    server::jobs::JobQueue& jobs_;
    server::jobs::JobId id_;
  };
  std::unique_ptr<Occupation> occupy_worker() { return std::make_unique<Occupation>(*jobs_); }

  /// Takes one of the places that bound how many requests of a kind are in work, until the result goes.
  server::api::Slot take_place(server::api::Slots server::api::Context::*slots) {
    return server::api::Slot(*context_.*slots);
  }

  /// "GET /tins 200" and so on: what has been answered so far.
  const std::set<std::string>& answered() const { return answered_; }
  std::uint16_t port() const { return port_; }
  /// As the program does when it is told to stop.
  void announce_stop() { context_->draining = true; }

 private:
  support::TempDir folder_;
  server::Config config_;
  std::unique_ptr<server::app::Catalogue> catalogue_;
  std::unique_ptr<server::jobs::JobQueue> jobs_;
  std::unique_ptr<server::api::Context> context_;
  std::unique_ptr<server::http::Server> server_;
  std::uint16_t port_ = 0;
  std::set<std::string> answered_;
};

/// The slug of a problem document: "/problems/not-found" gives "not-found".
std::string slug(const RawAnswer& answer);

/// An ASCII grid of 1 m cells, its lower left corner at (0, 0), the first row the northernmost.
std::string ascii_grid(const std::vector<std::vector<double>>& rows, double nodata = -9999);

/// columns x rows cells, each with an elevation of its own.
std::string ascii_grid(int columns, int rows);

}  // namespace tests::contract
