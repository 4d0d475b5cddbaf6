// Takes a request's body out of its framing, as the framing guard has read it. Knows no sockets.
//
// Our own reader, since Beast 1.74 reads a chunk's extension differently when it comes in pieces (an open
// quotation mark goes on over the end of the line), and so sees another end of the request. Here such a line
// is refused, and so is all else that the grammar (RFC 9112, 7.1) does not have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "server/http/framing.h"

namespace server::http {

class BodyParser {
 public:
  enum class State {
    kAgain,     // call again with the rest of the input: the block is full
    kNeedMore,  // the input is used up; call again with more
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

  explicit BodyParser(const Head& head);

  /// The most bytes that the body may have (of a chunk this is judged by its header), and that extensions and
  /// trailer may have together.
  void set_limits(std::uint64_t body_bytes, std::size_t framing_bytes);

  Step parse(std::string_view input, std::span<char> block);

  /// Whether the body has been read whole; true from the beginning if there is none.
  bool done() const { return at_ == At::kEnd; }

 private:
  enum class At {
    kSize,       // digits of a chunk's size
    kExtension,  // what follows them on the line
    kSizeLf,     // the line feed that ends the line
    kData,       // of a chunk, or of a body with a length
    kDataCr,
    kDataLf,
    kTrailer,  // a line after the last chunk
    kTrailerLf,
    kEnd,
    kBroken,
    kTooLarge,
  };

  void take_framing(char c);
  void take_size(char c);
  void take_of_line(char c);
  void end_size_line();
  void end_trailer_line();

  const bool chunked_;
  At at_;
  std::uint64_t left_ = 0;  // of the data of this chunk, or of the body
  std::uint64_t body_left_ = std::numeric_limits<std::uint64_t>::max();
  std::size_t framing_left_ = std::numeric_limits<std::size_t>::max();
  int digits_ = 0;
  std::string line_;  // an extension or a field of the trailer, as far as it has come
};

}  // namespace server::http
