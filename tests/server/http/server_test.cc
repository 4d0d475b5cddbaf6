// What a client sees of routing, bodies and errors, over real sockets.
#include "tests/server/http/fixture.h"

namespace tests::server_http {
namespace {

using ServerTest = HttpTest;

TEST_F(ServerTest, EveryAnswerHasTheCommonFields) {
  start();
  for (const char* line : {"GET /hello", "GET /nowhere", "GET /throw", "POST /hello", "GET /%zz", "BREW /"}) {
    const RawAnswer answer = ask(line);
    EXPECT_EQ(answer.header("access-control-allow-origin"), "*") << line;
    EXPECT_NE(answer.header("access-control-expose-headers").find("ETag, Location, Link, Content-Crs"),
              std::string::npos);
    EXPECT_EQ(answer.header("server"), "tinsmith") << line;
    EXPECT_NE(answer.header("x-request-id"), "") << line;
    EXPECT_NE(answer.header("date").find(" GMT"), std::string::npos) << line;
    EXPECT_TRUE(answer.complete) << line;
  }
}

TEST_F(ServerTest, PathsAndMethodsAreRouted) {
  add(Method::kGet, "/tins/{tin}", [](Request& r) {
    return text(std::string(r.path_parameter("tin")) + r.query_value("crs").value_or("-"));
  });
  start();
  EXPECT_EQ(ask("GET /tins/a%20b?crs=EPSG:4326").body, "a bEPSG:4326");
  EXPECT_EQ(ask("GET /tins/a").body, "a-");
  EXPECT_EQ(ask("GET /nowhere").status, 404);
  const RawAnswer wrong = ask("DELETE /tins/a");
  EXPECT_EQ(wrong.status, 405);
  EXPECT_EQ(wrong.header("allow"), "GET, HEAD, OPTIONS");
  const RawAnswer unknown = ask("GET /tins/a?csr=1");
  EXPECT_EQ(unknown.status, 400);
  EXPECT_EQ(unknown.body.substr(0, 10), "query:csr ");
  EXPECT_EQ(ask("BREW /hello").status, 501);
}

TEST_F(ServerTest, HeadAnswersWithoutABody) {
  start();
  RawClient client(port_);
  client.send("HEAD /hello HTTP/1.1\r\nHost: t\r\n\r\n");
  const RawAnswer head = client.read_answer(true);
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.header("content-length"), "5");
  EXPECT_EQ(client.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").body, "hello");
}

TEST_F(ServerTest, OptionsDescribeAPath) {
  start();
  const RawAnswer answer = ask("OPTIONS /echo", "Origin: x\r\nAccess-Control-Request-Method: POST\r\n");
  EXPECT_EQ(answer.status, 204);
  EXPECT_EQ(answer.header("allow"), "POST, OPTIONS");
  EXPECT_EQ(answer.header("access-control-allow-methods"), "POST, OPTIONS");
  EXPECT_NE(answer.header("access-control-allow-headers").find("If-Match"), std::string::npos);
  EXPECT_EQ(answer.header("content-length"), "");
  EXPECT_EQ(ask("OPTIONS /nowhere").status, 404);
}

TEST_F(ServerTest, PipelinedRequestsAreAnsweredInOrder) {
  start();
  RawClient client(port_);
  client.send(
      "POST /echo HTTP/1.1\r\nHost: t\r\nContent-Length: 3\r\n\r\none"
      "POST /echo HTTP/1.1\r\nHost: t\r\nTransfer-Encoding: chunked\r\n\r\n3\r\ntwo\r\n0\r\n\r\n"
      "\r\nGET /hello HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(client.read_answer().body, "one");
  EXPECT_EQ(client.read_answer().body, "two");
  const RawAnswer last = client.read_answer();
  EXPECT_EQ(last.body, "hello");
  EXPECT_EQ(last.header("connection"), "close");
  EXPECT_TRUE(client.closed());
}

TEST_F(ServerTest, ChunksArePutTogetherAndTrailersIgnored) {
  add(
      Method::kPost, "/who",
      [](Request& r) { return text(r.body + "|" + std::string(r.header("authorization"))); },
      BodyKind::kMemory);
  start();
  RawClient client(port_);
  client.send("POST /who HTTP/1.1\r\nHost: t\r\nTransfer-Encoding: chunked\r\n\r\n");
  for (const char* part :
       {"5;ext=1\r\nhel", "lo\r", "\n1\r\n \r\n0", "5\r\nworld\r\n0\r\nAuthorization: root\r\n\r\n"}) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    client.send(part);
  }
  EXPECT_EQ(client.read_answer().body, "hello world|");
  EXPECT_EQ(client.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").body, "hello");
}

TEST_F(ServerTest, UploadsArriveAsAFileThatGoesAway) {
  std::filesystem::path seen;
  std::filesystem::path kept;
  add(
      Method::kPost, "/see",
      [&](Request& r) {
        seen = r.body_file;
        const auto mode = std::filesystem::status(seen).permissions();
        return text(std::to_string(static_cast<int>(mode)) + " " + std::to_string(r.body.size()));
      },
      BodyKind::kFile);
  add(
      Method::kPost, "/keep",
      [&](Request& r) {
        kept = r.release_body_file();
        return text("");
      },
      BodyKind::kFile);
  start();
  std::string content(3'000'000, 'x');
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(i * i >> 3);
  const std::string length = "Content-Length: " + std::to_string(content.size()) + "\r\n";
  EXPECT_EQ(ask("POST /upload", length, content).body, content);
  EXPECT_EQ(ask("POST /see", length, content).body, "384 0");
  EXPECT_NE(seen, "");
  EXPECT_FALSE(std::filesystem::exists(seen));
  ask("POST /keep", length, content);
  EXPECT_EQ(read_file(kept), content);
  std::filesystem::remove(kept);
  EXPECT_TRUE(std::filesystem::is_empty(options_.upload_dir));
}

TEST_F(ServerTest, TheTypeDecidesWhereABodyGoes) {
  add(
      Method::kPost, "/tins", [](Request& r) { return text(r.body_file.empty() ? "memory" : "file"); },
      BodyKind::kByType);
  start();
  const std::string length = "Content-Length: 2\r\n";
  EXPECT_EQ(ask("POST /tins", length + "Content-Type: Application/JSON ; charset=utf-8\r\n", "{}").body,
            "memory");
  EXPECT_EQ(ask("POST /tins", length + "Content-Type: application/geo+json\r\n", "{}").body, "file");
  EXPECT_EQ(ask("POST /tins", length, "{}").body, "file");
}

TEST_F(ServerTest, ABodyWithoutAUseIsRefused) {
  start();
  EXPECT_EQ(ask("GET /hello", "Content-Length: 2\r\n", "{}").status, 400);
  EXPECT_EQ(ask("GET /hello", "Content-Length: 0\r\n").status, 200);
}

TEST_F(ServerTest, AnExceptionIsA500WithoutItsText) {
  add(Method::kGet, "/memory", [](Request&) -> Response { throw std::bad_alloc(); });
  add(Method::kGet, "/odd", [](Request&) -> Response { throw 7; });
  start();
  RawClient client(port_);
  const RawAnswer answer = client.ask("GET /throw HTTP/1.1\r\nHost: t\r\n\r\n");
  EXPECT_EQ(answer.status, 500);
  EXPECT_EQ(answer.body.find("secret"), std::string::npos);
  ASSERT_EQ(problems().size(), 1U);
  EXPECT_EQ(problems()[0].first, answer.header("x-request-id"));
  EXPECT_NE(problems()[0].second.find("secret detail"), std::string::npos);
  EXPECT_EQ(client.ask("GET /memory HTTP/1.1\r\nHost: t\r\n\r\n").status, 503);
  EXPECT_EQ(client.ask("GET /odd HTTP/1.1\r\nHost: t\r\n\r\n").status, 500);
  EXPECT_EQ(client.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").status, 200);
}

TEST_F(ServerTest, AMatchingTagIsAnsweredWith304) {
  add(Method::kGet, "/tagged", [](Request&) { return Response{200, {{"ETag", "\"r7\""}}, "content"}; });
  start();
  RawClient client(port_);
  const RawAnswer unchanged =
      client.ask("GET /tagged HTTP/1.1\r\nHost: t\r\nIf-None-Match: \"r6\", W/\"r7\"\r\n\r\n");
  EXPECT_EQ(unchanged.status, 304);
  EXPECT_EQ(unchanged.header("etag"), "\"r7\"");
  const RawAnswer changed = client.ask("GET /tagged HTTP/1.1\r\nHost: t\r\nIf-None-Match: \"r6\"\r\n\r\n");
  EXPECT_EQ(changed.status, 200);
  EXPECT_EQ(changed.body, "content");
}

TEST_F(ServerTest, FilesAreSentWithTheirLength) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "http-file-body";
  const std::string content(700'001, 'f');
  add(Method::kGet, "/file", [&](Request&) { return Response{200, {}, FileBody{path, true}}; });
  start();
  std::ofstream(path, std::ios::binary) << content;
  const RawAnswer answer = ask("GET /file");
  EXPECT_EQ(answer.header("content-length"), "700001");
  EXPECT_TRUE(answer.body == content);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(ask("GET /file").status, 500);
}

TEST_F(ServerTest, OldClientsAreServed) {
  add(Method::kGet, "/stream", [](Request&) {
    return streaming([](int i, std::string& piece) {
      piece = "part" + std::to_string(i);
      return i < 3;
    });
  });
  start();
  RawClient client(port_);
  const RawAnswer kept = client.ask("GET /hello HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  EXPECT_EQ(kept.header("connection"), "keep-alive");
  const RawAnswer streamed = client.ask("GET /stream HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  EXPECT_EQ(streamed.header("transfer-encoding"), "");
  EXPECT_EQ(streamed.header("connection"), "close");
  EXPECT_EQ(streamed.body, "part0part1part2");
}

TEST_F(ServerTest, AccessesAreReported) {
  start();
  ask("GET /hello?limit=1");
  ask("GET /nowhere");
  server_->stop();
  const std::vector<Access> all = accesses();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].method, "GET");
  EXPECT_EQ(all[0].route, "/hello");
  EXPECT_EQ(all[0].peer, "127.0.0.1");
  EXPECT_EQ(all[0].status, 200);
  EXPECT_GT(all[0].bytes_sent, 100U);
  EXPECT_FALSE(all[0].cut);
  EXPECT_EQ(all[1].route, "");
  EXPECT_EQ(all[1].path, "/nowhere");
  EXPECT_NE(all[0].request_id, all[1].request_id);
}

/// Requests of which a lenient server would see a second, smuggled one.
TEST_F(ServerTest, NothingIsSmuggledBehindAnAmbiguousHead) {
  std::atomic<int> smuggled = 0;
  add(Method::kGet, "/secret", [&](Request&) {
    ++smuggled;
    return text("s");
  });
  start();
  const std::string second = "GET /secret HTTP/1.1\r\nHost: t\r\n\r\n";
  const std::string chunked = "0\r\n\r\n" + second;
  const std::vector<std::pair<std::string, std::string>> vectors = {
      {"Transfer-Encoding: xchunked\r\n", second},
      {"Transfer-Encoding: identity\r\n", second},
      {"Transfer-Encoding: chunked, gzip\r\n", second},
      {"Transfer-Encoding: chunked, chunked\r\n", chunked},
      {"Transfer-Encoding: chunked\r\nContent-Length: 5\r\n", chunked},
      {"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n", chunked},
      {"Content-Length: 0\r\nContent-Length: 38\r\n", second},
      {"Transfer-Encoding : chunked\r\n", chunked},
      {"X: a\r\n Transfer-Encoding: chunked\r\n", chunked},
      {"Transfer-Encoding: chunked\r\n", "5 5\r\nhello\r\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "0x5\r\nhello\r\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "-5\r\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "5\nhello\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "5\r\nhelloXX" + chunked},
      {"Transfer-Encoding: chunked\r\n", "ffffffffffffffff1\r\nhello\r\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "5;\"\r\nhello\r\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "5;a=" + std::string(2000, 'x') + "\r\nhello\r\n" + chunked},
      {"Transfer-Encoding: chunked\r\n", "5;a=" + std::string(200'000, 'x') + "\r\nhello\r\n" + chunked},
  };
  for (const auto& [fields, body] : vectors) {
    RawClient client(port_);
    client.send("POST /echo HTTP/1.1\r\nHost: t\r\n" + fields + "\r\n" + body);
    const RawAnswer answer = client.read_answer();
    EXPECT_GE(answer.status, 400) << fields << body.substr(0, 20);
    EXPECT_EQ(answer.header("connection"), "close") << fields << body.substr(0, 20);
    client.finish_sending();
    EXPECT_EQ(client.read_to_end(), "") << fields << body.substr(0, 20);
  }
  EXPECT_EQ(smuggled, 0);
}

}  // namespace
}  // namespace tests::server_http
