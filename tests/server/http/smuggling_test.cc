// Requests that two readers could end at different places, sent as raw bytes: each is refused and the
// connection closed, or read in the one way that is written here. What hides in it must never be answered.
#include <gtest/gtest.h>

#include <atomic>

#include "tests/server/http/fixture.h"

namespace tests::server_http {
namespace {

using namespace std::string_literals;

/// What somebody would smuggle past a proxy.
const std::string kHidden = "GET /hidden HTTP/1.1\r\nHost: t\r\n\r\n";

std::string post(const std::string& fields, const std::string& body) {
  return "POST /echo HTTP/1.1\r\nHost: t\r\n" + fields + "\r\n" + body;
}

struct Vector {
  const char* name;
  std::string bytes;
  int status;  // of the only answer, after which the connection is closed
};

std::vector<Vector> refused() {
  const std::string zero = "0\r\n\r\n";
  const std::string length = "Content-Length: " + std::to_string(kHidden.size()) + "\r\n";
  const std::string chunked = "Transfer-Encoding: chunked\r\n";
  std::vector<Vector> all = {
      {"CL.TE", post("Content-Length: 5\r\n" + chunked, zero + kHidden), 400},
      {"TE.CL", post(chunked + "Content-Length: 5\r\n", zero + kHidden), 400},
      {"CL.CL", post("Content-Length: 0\r\n" + length, kHidden), 400},
      {"CL.CL equal", post(length + length, kHidden), 400},
      {"CL list", post("Content-Length: 0, 34\r\n", kHidden), 400},
      {"CL with plus", post("Content-Length: +0\r\n", kHidden), 400},
      {"CL negative", post("Content-Length: -1\r\n", kHidden), 400},
      {"CL hexadecimal", post("Content-Length: 0x0\r\n", kHidden), 400},
      {"CL empty", post("Content-Length: \r\n", kHidden), 400},
      {"CL with a blank inside", post("Content-Length: 0 0\r\n", kHidden), 400},
      {"CL in exponent form", post("Content-Length: 0e1\r\n", kHidden), 400},
      {"CL over 64 bits", post("Content-Length: 18446744073709551616\r\n", kHidden), 413},
      {"CL with a comma only", post("Content-Length: ,\r\n", kHidden), 400},
      {"CL with a vertical tab", post("Content-Length: \v0\r\n", kHidden), 400},
      {"CL with NUL", post("Content-Length: 0\0\r\n"s, kHidden), 400},
      {"CL in Unicode digits", post("Content-Length: \xd9\xa0\r\n", kHidden), 400},
      {"CL with a space before the colon", post("Content-Length : 0\r\n", kHidden), 400},
      {"CL folded", post("Content-Length:\r\n 0\r\n", kHidden), 400},
      {"CL hidden behind a bare CR", post("X: a\rContent-Length: 0\r\n", kHidden), 400},
      {"CL hidden behind a bare LF", post("X: a\nContent-Length: 0\r\n", kHidden), 400},
      {"xchunked", post("Transfer-Encoding: xchunked\r\n", zero + kHidden), 501},
      {"identity", post("Transfer-Encoding: identity\r\n", kHidden), 501},
      {"chunked, identity", post("Transfer-Encoding: chunked, identity\r\n", zero + kHidden), 501},
      {"identity, chunked", post("Transfer-Encoding: identity, chunked\r\n", zero + kHidden), 501},
      {"gzip, chunked", post("Transfer-Encoding: gzip, chunked\r\n", zero + kHidden), 501},
      {"chunked twice", post("Transfer-Encoding: chunked, chunked\r\n", zero + kHidden), 400},
      {"chunked in two fields", post(chunked + chunked, zero + kHidden), 400},
      {"chunked in quotes", post("Transfer-Encoding: \"chunked\"\r\n", zero + kHidden), 501},
      {"chunked with a parameter", post("Transfer-Encoding: chunked;a=b\r\n", zero + kHidden), 501},
      {"chunked behind a vertical tab", post("Transfer-Encoding: \vchunked\r\n", zero + kHidden), 400},
      {"chunked behind a form feed", post("Transfer-Encoding: \fchunked\r\n", zero + kHidden), 400},
      {"chunked with NUL", post("Transfer-Encoding: chunked\0\r\n"s, zero + kHidden), 400},
      {"chunked folded", post("Transfer-Encoding:\r\n chunked\r\n", zero + kHidden), 400},
      {"chunked with a comma", post("Transfer-Encoding: ,chunked\r\n", zero + kHidden), 501},
      {"TE with a space before the colon", post("Transfer-Encoding : chunked\r\n", zero + kHidden), 400},
      {"TE with a tab before the colon", post("Transfer-Encoding\t: chunked\r\n", zero + kHidden), 400},
      {"TE after a space", post(" Transfer-Encoding: chunked\r\n", zero + kHidden), 400},
      {"TE empty", post("Transfer-Encoding:\r\n", kHidden), 400},
      {"TE hidden behind a bare LF", post("X: a\nTransfer-Encoding: chunked\r\n", zero + kHidden), 400},
      {"TE with NUL in its name", post("Transfer-Encoding\0: chunked\r\n"s, zero + kHidden), 400},
      {"TE on HTTP/1.0", "POST /echo HTTP/1.0\r\n" + chunked + "\r\n" + zero + kHidden, 400},
      {"TE on HTTP/1.0 with CL", "POST /echo HTTP/1.0\r\nContent-Length: 0\r\n" + chunked + "\r\n" + kHidden,
       400},
      {"lines ended by LF", "POST /echo HTTP/1.1\nHost: t\nContent-Length: 0\n\n" + kHidden, 400},
      {"head ended by LF LF", "POST /echo HTTP/1.1\r\nHost: t\r\nX: a\n\n" + kHidden, 400},
      {"head ended by LF CR LF", "POST /echo HTTP/1.1\r\nHost: t\r\nX: a\n\r\n" + kHidden, 400},
      {"two hosts", "GET /hello HTTP/1.1\r\nHost: t\r\nHost: u\r\n\r\n" + kHidden, 400},
      {"no host", "GET /hello HTTP/1.1\r\n\r\n" + kHidden, 400},
      {"another host in the target", "GET http://u/hello HTTP/1.1\r\nHost: t\r\n\r\n" + kHidden, 400},
      {"space in the target", "GET /hello /hidden HTTP/1.1\r\nHost: t\r\n\r\n" + kHidden, 400},
      {"a second version", "GET /hello HTTP/1.1 HTTP/1.1\r\nHost: t\r\n\r\n" + kHidden, 400},
      {"tab in the request line", "GET\t/hello HTTP/1.1\r\nHost: t\r\n\r\n" + kHidden, 400},
      {"HTTP/0.9", "GET /hello\r\n\r\n" + kHidden, 400},
      {"HTTP/1.2", "GET /hello HTTP/1.2\r\nHost: t\r\n\r\n" + kHidden, 505},
      {"HTTP/2 preface", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + kHidden, 505},
      {"body on a GET", "GET /hello HTTP/1.1\r\nHost: t\r\n" + length + "\r\n" + kHidden, 400},
      {"chunked body on a GET",
       "GET /hello HTTP/1.1\r\nHost: t\r\n" + chunked + "\r\n" + chunk(kHidden) + zero, 400},
      {"chunk size with 0x", post(chunked, "0x0\r\n\r\n" + kHidden), 400},
      {"chunk size negative", post(chunked, "-1\r\n\r\n" + kHidden), 400},
      {"chunk size with plus", post(chunked, "+0\r\n\r\n" + kHidden), 400},
      {"chunk size empty", post(chunked, "\r\n" + zero + kHidden), 400},
      {"chunk size over 64 bits", post(chunked, "10000000000000000\r\nx\r\n" + zero + kHidden), 400},
      {"chunk size ended by LF", post(chunked, "1\nx\r\n" + zero + kHidden), 400},
      {"chunk size ended by CR", post(chunked, "1\rx\r\n" + zero + kHidden), 400},
      {"chunk without CR LF behind it", post(chunked, "1\r\nx" + zero + kHidden), 400},
      {"chunk longer than its size", post(chunked, "1\r\nxy\r\n" + zero + kHidden), 400},
      {"chunk extension ended by LF", post(chunked, "1;a\nx\r\n" + zero + kHidden), 400},
      {"last chunk ended by LF", post(chunked, "0\n\n" + kHidden), 400},
  };
  return all;
}

class SmugglingTest : public HttpTest {
 protected:
  SmugglingTest() {
    add(Method::kGet, "/hidden", [this](Request&) {
      ++hidden_;
      return text("hidden");
    });
    options_.header_timeout = std::chrono::milliseconds(2000);
  }
  std::atomic<int> hidden_{0};
};

TEST_F(SmugglingTest, RequestsWithTwoMeaningsAreRefusedAndTheConnectionCloses) {
  start();
  const auto vectors = refused();
  ASSERT_GE(vectors.size(), 60U);
  for (const Vector& v : vectors) {
    RawClient client(port_);
    client.send(v.bytes);
    const RawAnswer answer = client.read_answer();
    EXPECT_EQ(answer.status, v.status) << v.name << ": " << answer.body;
    EXPECT_EQ(answer.header("connection"), "close") << v.name;
    EXPECT_TRUE(client.closed()) << v.name;
    EXPECT_EQ(hidden_, 0) << v.name;
  }
}

/// The same bytes one after the other, so that each ends a packet.
TEST_F(SmugglingTest, PiecesChangeNothing) {
  start();
  for (const Vector& v : refused()) {
    RawClient client(port_);
    for (const char c : v.bytes) {
      if (!client.send(std::string_view(&c, 1))) break;
    }
    EXPECT_EQ(client.read_answer().status, v.status) << v.name;
    EXPECT_EQ(hidden_, 0) << v.name;
  }
}

TEST_F(SmugglingTest, WhatIsAllowedHasOneMeaning) {
  start();
  const std::string length = "Content-Length: " + std::to_string(kHidden.size()) + "\r\n";
  const std::string chunked = "Transfer-Encoding: chunked\r\n";
  const Vector bodies[] = {
      {"a length", post(length, kHidden), 200},
      {"a length with leading zeros",
       post("Content-Length: 00" + std::to_string(kHidden.size()) + "\r\n", kHidden), 200},
      {"chunks", post(chunked, chunk(kHidden) + "0\r\n\r\n"), 200},
      {"chunks of one byte",
       post(chunked,
            [] {
              std::string all;
              for (const char c : kHidden) all += chunk(std::string(1, c));
              return all + "0\r\n\r\n";
            }()),
       200},
      {"chunked in capitals", post("TRANSFER-ENCODING: CHUNKED\r\n", chunk(kHidden) + "0\r\n\r\n"), 200},
      {"an extension", post(chunked, "021;a=\"b\"\r\n" + kHidden + "\r\n0;x\r\n\r\n"), 200},
      {"a trailer", post(chunked, chunk(kHidden) + "0\r\nContent-Length: 0\r\nX: y\r\n\r\n"), 200},
  };
  for (const Vector& v : bodies) {
    RawClient client(port_);
    client.send(v.bytes + "GET /hello HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n");
    const RawAnswer first = client.read_answer(), second = client.read_answer();
    EXPECT_EQ(first.status, v.status) << v.name;
    EXPECT_EQ(first.body, kHidden) << v.name;
    EXPECT_EQ(second.body, "hello") << v.name;
    EXPECT_TRUE(client.closed()) << v.name;
    EXPECT_EQ(hidden_, 0) << v.name;
  }
}

TEST_F(SmugglingTest, ALongChunkExtensionIsRefused) {
  start();
  RawClient client(port_);
  client.send(post("Transfer-Encoding: chunked\r\n",
                   "1;" + std::string(20'000, 'a') + "\r\nx\r\n0\r\n\r\n" + kHidden));
  EXPECT_EQ(client.read_answer().status, 400);
  EXPECT_EQ(hidden_, 0);
}

TEST_F(SmugglingTest, ATrailerWithoutEndIsRefused) {
  start();
  RawClient client(port_);
  client.send(post("Transfer-Encoding: chunked\r\n", "0\r\n"));
  for (int i = 0; i < 2000; ++i) {
    if (!client.send("X-" + std::to_string(i) + ": y\r\n")) break;
  }
  EXPECT_EQ(client.read_answer().status, 400);
}

}  // namespace
}  // namespace tests::server_http
