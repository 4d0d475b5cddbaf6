// Changes as server-sent events: a body that goes on as revisions come.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "server/api/slots.h"
#include "server/app/catalogue.h"
#include "server/http/message.h"

namespace server::api {

class ChangeStream : public http::BodySource {
 public:
  /// From the revision after `since` on. Takes over a place that was acquired from `listeners`.
  ChangeStream(app::Catalogue& catalogue, std::shared_ptr<app::Tin> tin, std::uint64_t since,
               Slots& listeners);
  ~ChangeStream() override;

  bool next(std::string& piece) override;

 private:
  using Clock = std::chrono::steady_clock;

  bool append_changes(std::string& piece);
  void end(std::string& piece, std::string_view event, std::string_view why);

  app::Catalogue& catalogue_;
  const std::shared_ptr<app::Tin> tin_;
  std::uint64_t sent_;
  Slots& listeners_;
  Clock::time_point last_sign_;
  bool begun_ = false;
  bool ended_ = false;
};

}  // namespace server::api
