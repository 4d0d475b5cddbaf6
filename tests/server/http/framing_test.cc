// The framing guard against the vectors of request smuggling, without a socket.
#include "server/http/framing.h"

#include <gtest/gtest.h>

namespace tests::server_http {
namespace {

using server::http::Head;
using server::http::HeadLimits;
using server::http::read_head;
using server::http::Refusal;

int status_of(const std::string& raw, const HeadLimits& limits = {}) {
  const auto read = read_head(raw, limits);
  const Refusal* refusal = std::get_if<Refusal>(&read);
  return refusal == nullptr ? 200 : refusal->status;
}

Head head_of(const std::string& raw) {
  auto read = read_head(raw, {});
  if (const Refusal* refusal = std::get_if<Refusal>(&read)) ADD_FAILURE() << refusal->detail;
  return std::get<Head>(std::move(read));
}

struct HeadVector {
  const char* name;
  std::string fields;  // after "POST / HTTP/1.1" and a Host
  int status;
};

TEST(FramingTest, AmbiguousFieldsAreRefused) {
  using namespace std::string_literals;
  const std::vector<HeadVector> vectors = {
      {"plain", "", 200},
      {"length", "Content-Length: 5\r\n", 200},
      {"chunked", "Transfer-Encoding: chunked\r\n", 200},
      {"chunked in capitals", "TRANSFER-ENCODING: Chunked\r\n", 200},
      {"length and chunked", "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n", 400},
      {"chunked and length", "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n", 400},
      {"two equal lengths", "Content-Length: 5\r\nContent-Length: 5\r\n", 400},
      {"two lengths", "Content-Length: 5\r\nContent-Length: 6\r\n", 400},
      {"list of lengths", "Content-Length: 5, 5\r\n", 400},
      {"signed length", "Content-Length: +5\r\n", 400},
      {"negative length", "Content-Length: -5\r\n", 400},
      {"hexadecimal length", "Content-Length: 0x5\r\n", 400},
      {"empty length", "Content-Length:\r\n", 400},
      {"length with a space inside", "Content-Length: 1 0\r\n", 400},
      {"length over 64 bits", "Content-Length: 18446744073709551621\r\n", 413},
      {"xchunked", "Transfer-Encoding: xchunked\r\n", 501},
      {"identity", "Transfer-Encoding: identity\r\n", 501},
      {"gzip, chunked", "Transfer-Encoding: gzip, chunked\r\n", 501},
      {"chunked, gzip", "Transfer-Encoding: chunked, gzip\r\n", 501},
      {"chunked, chunked", "Transfer-Encoding: chunked, chunked\r\n", 400},
      {"chunked in two fields", "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", 400},
      {"chunked and identity", "Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n", 400},
      {"quoted chunked", "Transfer-Encoding: \"chunked\"\r\n", 501},
      {"chunked with a parameter", "Transfer-Encoding: chunked;q=1\r\n", 501},
      {"vertical tab before chunked", "Transfer-Encoding: \vchunked\r\n", 400},
      {"empty encoding", "Transfer-Encoding:\r\n", 400},
      {"space before the colon", "Transfer-Encoding : chunked\r\n", 400},
      {"tab before the colon", "Content-Length\t: 5\r\n", 400},
      {"folded field", "X: a\r\n b\r\n", 400},
      {"folded encoding", "Transfer-Encoding:\r\n chunked\r\n", 400},
      {"space before the name", " Content-Length: 5\r\n", 400},
      {"line feed alone", "X: a\nContent-Length: 5\r\n", 400},
      {"carriage return alone", "X: a\rContent-Length: 5\r\n", 400},
      {"NUL in a value", "X: a\0b\r\n"s, 400},
      {"NUL in a name", "X\0Y: b\r\n"s, 400},
      {"DEL in a value", "X: a\x7f\r\n", 400},
      {"no colon", "Content-Length 5\r\n", 400},
      {"no name", ": 5\r\n", 400},
      {"byte above ASCII in a name", "X\xc3\xa9: 5\r\n", 400},
      {"byte above ASCII in a value", "X: \xc3\xa9\r\n", 200},
      {"second host", "Host: u\r\n", 400},
      {"expectation of ours", "Expect: 100-continue\r\n", 200},
      {"other expectation", "Expect: magic\r\n", 417},
      {"malformed connection", "Connection: close@\r\n", 400},
  };
  for (const HeadVector& v : vectors) {
    EXPECT_EQ(status_of("POST / HTTP/1.1\r\nHost: t\r\n" + v.fields + "\r\n"), v.status) << v.name;
  }
}

TEST(FramingTest, TheHostIsNeededOnceAndIsAHost) {
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET / HTTP/1.0\r\n\r\n"), 200);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: [::1]:8080\r\n\r\n"), 200);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: a, b\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: a/b\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: u@a\r\n\r\n"), 400);
}

TEST(FramingTest, OldVersionsDoNotChunk) {
  EXPECT_EQ(status_of("POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET / HTTP/2.0\r\nHost: t\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / HTTP/1.2\r\nHost: t\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / http/1.1\r\nHost: t\r\n\r\n"), 400);
}

TEST(FramingTest, TheRequestLineHasThreeParts) {
  EXPECT_EQ(status_of("GET /\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET  / HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET / a HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("G(T / HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("BREW / HTTP/1.1\r\nHost: t\r\n\r\n"), 501);
  EXPECT_EQ(status_of("get / HTTP/1.1\r\nHost: t\r\n\r\n"), 501);
  EXPECT_EQ(status_of("CONNECT t:80 HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("OPTIONS * HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET /\xc3\xa9 HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
}

TEST(FramingTest, AnAbsoluteTargetMustNameTheHost) {
  EXPECT_EQ(head_of("GET http://T:80/a?b=c HTTP/1.1\r\nHost: t:80\r\n\r\n").target, "/a?b=c");
  EXPECT_EQ(head_of("GET HTTPS://t HTTP/1.1\r\nHost: t\r\n\r\n").target, "/");
  EXPECT_EQ(head_of("GET http://t?x HTTP/1.1\r\nHost: t\r\n\r\n").target, "/?x");
  EXPECT_EQ(status_of("GET http://other/ HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET http:///a HTTP/1.1\r\nHost: t\r\n\r\n"), 400);
}

TEST(FramingTest, LimitsHoldAtTheirValueAndNotOnePast) {
  const HeadLimits limits{.target_bytes = 10, .fields = 3};
  EXPECT_EQ(status_of("GET /123456789 HTTP/1.1\r\nHost: t\r\n\r\n", limits), 200);
  EXPECT_EQ(status_of("GET /1234567890 HTTP/1.1\r\nHost: t\r\n\r\n", limits), 414);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: t\r\nA: 1\r\nB: 2\r\n\r\n", limits), 200);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: t\r\nA: 1\r\nB: 2\r\nC: 3\r\n\r\n", limits), 431);
}

TEST(FramingTest, ConnectionsStayOpenAsTheVersionSays) {
  EXPECT_TRUE(head_of("GET / HTTP/1.1\r\nHost: t\r\n\r\n").keep_alive);
  EXPECT_FALSE(head_of("GET / HTTP/1.1\r\nHost: t\r\nConnection: TE, Close\r\n\r\n").keep_alive);
  EXPECT_FALSE(head_of("GET / HTTP/1.0\r\n\r\n").keep_alive);
  EXPECT_TRUE(head_of("GET / HTTP/1.0\r\nConnection: Keep-Alive\r\n\r\n").keep_alive);
}

TEST(FramingTest, RepeatedFieldsAreJoined) {
  const Head head = head_of("GET / HTTP/1.1\r\nHost: t\r\nAccept: a\r\nX: 1\r\naccept:  b \r\n\r\n");
  EXPECT_EQ(head.headers, (server::http::NamedValues{{"host", "t"}, {"accept", "a, b"}, {"x", "1"}}));
}

}  // namespace
}  // namespace tests::server_http
