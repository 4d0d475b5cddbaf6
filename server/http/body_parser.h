// Takes a request's body out of its framing, by Beast's parser behind the framing guard. Knows no sockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "server/http/framing.h"

namespace server::http {

class BodyParser {
 public:
  enum class State {
    kAgain,     // call again with the rest of the input
    kNeedMore,  // call again with the rest of the input and more
    kDone,
    kTooLarge,  // a Content-Length or the chunks so far are over the limit
    kBroken,
  };

  /// What one call did: it used so many bytes of the input, and put so many at the front of the block.
  struct Step {
    State state = State::kBroken;
    std::size_t used = 0;
    std::size_t filled = 0;
  };

  BodyParser();
  ~BodyParser();

  /// Takes the head that the guard read as `head`. Returns whether both see the same framing.
  bool begin(std::string_view raw, const Head& head);

  /// The most bytes that the body may have: of a chunk this is judged by its header.
  void set_limit(std::uint64_t bytes);

  Step parse(std::string_view input, std::span<char> block);

  /// Whether the body has been read whole; true from begin() on if there is none.
  bool done() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace server::http
