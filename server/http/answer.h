// From a handler's response to what goes over the wire: the head's bytes, and a body with known framing.
// All that the server adds to every answer is added here. Knows no sockets.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "server/http/message.h"

namespace server::http {

/// What the answer has to know of its request.
struct AnswerContext {
  Method method = Method::kGet;
  int minor = 1;
  bool keep_alive = true;  // false: this is the last answer on the connection
  std::string request_id;
  std::string if_none_match;  // of the request; "" if it had none
  std::string accept_encoding;
  std::size_t compress_from = 0;  // bytes of a body that is worth it; 0: never
};

enum class Framing {
  kNone,    // no body: HEAD, 204, 304
  kString,  // `body`
  kLength,  // `source`, of a length that the head states
  kChunked,
  kClose,  // `source` until the connection ends (HTTP/1.0)
};

struct Answer {
  int status = 200;
  std::string head;  // with its empty line
  Framing framing = Framing::kNone;
  std::string body;
  std::unique_ptr<BodySource> source;
  bool keep_alive = true;
};

/// Makes the answer. Opens a FileBody; throws std::system_error if that fails.
Answer make_answer(Response response, const AnswerContext& context);

/// Whether an If-None-Match field holds `etag` (weak comparison) or is "*".
bool none_match_hits(std::string_view if_none_match, std::string_view etag);

}  // namespace server::http
