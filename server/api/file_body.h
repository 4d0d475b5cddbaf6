// Answers that are made as a file first, which takes a while.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string_view>

#include "server/api/answer.h"
#include "server/api/routes.h"

namespace server::api {

/// Ends the making of a file that takes too long, or that nobody will get.
class Patience {
 public:
  Patience(const Request& request, std::int64_t seconds)
      : request_(request),
        seconds_(seconds),
        end_(std::chrono::steady_clock::now() + std::chrono::seconds(seconds)) {}
  /// Errors: kCancelled, kTooLarge.
  Result<void> check() const;

 private:
  const Request& request_;
  const std::int64_t seconds_;
  const std::chrono::steady_clock::time_point end_;
};

tin::base::Error too_many_exports();

/// A temporary file that becomes the answer's body, or goes. It is made under one of the context's slots.
/// Errors: kTooMany; those of `write`.
Result<http::Body> file_body(Context& context, std::string_view suffix,
                             const std::function<Result<void>(const std::filesystem::path&)>& write);

}  // namespace server::api
