#include "server/http/body_parser.h"

#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <limits>

namespace server::http {
namespace {

namespace http = boost::beast::http;
using boost::system::error_code;

constexpr std::size_t kMaxChunkExtension = 1024;

/// Beast reads chunk extensions of any length and gives them to this.
void check_chunk(std::uint64_t, boost::beast::string_view extension, error_code& ec) {
  if (extension.size() > kMaxChunkExtension) ec = http::error::bad_chunk_extension;
}

}  // namespace

class BodyParser::Impl {
 public:
  Impl() {
    parser_.header_limit(std::numeric_limits<std::uint32_t>::max());  // the guard has seen to it
    parser_.body_limit(std::numeric_limits<std::uint64_t>::max());    // until set_limit
    parser_.eager(true);
    parser_.on_chunk_header(check_chunk_);
  }

  http::request_parser<http::buffer_body> parser_;

 private:
  // The parser keeps a reference to its callback.
  void (*check_chunk_)(std::uint64_t, boost::beast::string_view, error_code&) = check_chunk;
};

BodyParser::BodyParser() : impl_(std::make_unique<Impl>()) {}

BodyParser::~BodyParser() = default;

bool BodyParser::begin(std::string_view raw, const Head& head) {
  auto& parser = impl_->parser_;
  error_code ec;
  const std::size_t used = parser.put(boost::asio::buffer(raw.data(), raw.size()), ec);
  if (ec == http::error::need_more) ec = {};
  if (ec || used != raw.size() || !parser.is_header_done() || parser.chunked() != head.chunked) return false;
  const auto length = parser.content_length();
  return length.has_value() == head.content_length.has_value() &&
         (!length || *length == *head.content_length);
}

void BodyParser::set_limit(std::uint64_t bytes) {
  impl_->parser_.body_limit(bytes);
}

BodyParser::Step BodyParser::parse(std::string_view input, std::span<char> block) {
  auto& parser = impl_->parser_;
  auto& body = parser.get().body();
  body.data = block.data();
  body.size = block.size();
  error_code ec;
  Step step;
  step.used = parser.put(boost::asio::buffer(input.data(), input.size()), ec);
  step.filled = block.size() - body.size;
  if (parser.is_done()) {
    step.state = State::kDone;
  } else if (ec == http::error::need_buffer || (!ec && step.used < input.size())) {
    step.state = State::kAgain;
  } else if (!ec || ec == http::error::need_more) {
    step.state = State::kNeedMore;
  } else {
    step.state = ec == http::error::body_limit ? State::kTooLarge : State::kBroken;
  }
  return step;
}

bool BodyParser::done() const {
  return impl_->parser_.is_done();
}

}  // namespace server::http
