// Tokens: what needs which, and how those without are refused.
#include <gtest/gtest.h>

#include "server/auth/tokens.h"
#include "tests/contract/test_server.h"
#include "tests/support/schema_check.h"

namespace tests::contract {
namespace {

const std::string kReader = "tinsmith_reader", kWriter = "tinsmith_writer", kBoth = "tinsmith_both";

void with_tokens(server::Config& config) {
  config.auth.tokens = {{"reader", server::auth::hash_token(kReader), true, false},
                        {"writer", server::auth::hash_token(kWriter), false, true},
                        {"both", server::auth::hash_token(kBoth), true, true}};
}

std::string bearer(const std::string& token) {
  return "Authorization: Bearer " + token + "\r\n";
}

TEST(AccessTest, WithoutTokensAnybodyMayDoAnything) {
  TestServer server;
  EXPECT_EQ(server.post_json("/tins", R"({"id":"t"})").status, 201);
  EXPECT_EQ(server.get("/tins", bearer("whatever")).status, 200);
}

TEST(AccessTest, ReadingAndWritingNeedTheirScopes) {
  TestServer server(with_tokens);
  const std::string body = R"({"id":"t","vertices":[[0,0,1],[1,0,2],[0,1,3]]})";
  EXPECT_EQ(server.post_json("/tins", body).status, 401);
  EXPECT_EQ(server.post_json("/tins", body, bearer(kReader)).status, 403);
  EXPECT_EQ(server.post_json("/tins", body, bearer(kWriter)).status, 201);
  EXPECT_EQ(server.get("/tins/t").status, 401);
  EXPECT_EQ(server.get("/tins/t", bearer(kWriter)).status, 403);
  EXPECT_EQ(server.get("/tins/t", bearer(kReader)).status, 200);
  EXPECT_EQ(server.ask({"HEAD", "/tins/t", {}, {}, bearer(kReader)}).status, 200);
  EXPECT_EQ(server.ask({"DELETE", "/tins/t", {}, {}, bearer(kReader)}).status, 403);
  EXPECT_EQ(server.ask({"DELETE", "/tins/t", {}, {}, bearer(kBoth)}).status, 204);
}

TEST(AccessTest, AskingManyPositionsIsReading) {
  TestServer server(with_tokens);
  ASSERT_EQ(
      server.post_json("/tins", R"({"id":"t","vertices":[[0,0,1],[1,0,2],[0,1,3]]})", bearer(kBoth)).status,
      201);
  EXPECT_EQ(server.post_json("/tins/t/elevation", R"({"positions":[[0,0]]})", bearer(kReader)).status, 200);
}

TEST(AccessTest, RefusalsSayWhatIsMissing) {
  TestServer server(with_tokens);
  EXPECT_EQ(server.get("/tins").header("www-authenticate"), "Bearer realm=\"tinsmith\"");
  for (const std::string field : {"Bearer tinsmith_readee", "Bearer ", "Basic dGluOnNtaXRo",
                                  "Bearer tinsmith_reader x", "tinsmith_reader"}) {
    const RawAnswer answer = server.get("/tins", "Authorization: " + field + "\r\n");
    EXPECT_EQ(answer.status, 401) << field;
    EXPECT_EQ(slug(answer), "unauthorized");
  }
  EXPECT_NE(server.get("/tins", bearer("wrong")).header("www-authenticate").find("invalid_token"),
            std::string::npos);
  const RawAnswer scope = server.remove("/tins/t");
  EXPECT_EQ(scope.status, 401);
  const RawAnswer small = server.ask({"DELETE", "/tins/t", {}, {}, bearer(kReader)});
  EXPECT_EQ(slug(small), "forbidden");
  EXPECT_NE(small.header("www-authenticate").find("insufficient_scope"), std::string::npos);
}

TEST(AccessTest, ABodyIsNotReadBeforeItsSenderIsKnown) {
  TestServer server(with_tokens);
  support::RawClient client(server.port());
  client.send("POST /tins HTTP/1.1\r\nHost: t\r\nContent-Length: 1000000\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(client.read_answer().status, 401);
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
}

TEST(AccessTest, ATrailerIsNoCredential) {
  TestServer server(with_tokens);
  support::RawClient client(server.port());
  client.send(
      "POST /tins HTTP/1.1\r\nHost: t\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
      "2\r\n{}\r\n0\r\nAuthorization: Bearer " +
      kBoth + "\r\n\r\n");
  EXPECT_EQ(client.read_answer().status, 401);
}

TEST(AccessTest, HealthAndTheContractAreOpen) {
  TestServer server(with_tokens);
  for (const char* path : {"/", "/api", "/conformance", "/healthz", "/readyz"})
    EXPECT_EQ(server.get(path).status, 200) << path;
  for (const char* path : {"/metrics", "/jobs", "/processes"}) {
    EXPECT_EQ(server.get(path).status, 401) << path;
    EXPECT_EQ(server.get(path, bearer(kReader)).status, 200) << path;
  }
  EXPECT_EQ(server.ask({"OPTIONS", "/tins"}).status, 204) << "a browser asks without credentials";
}

TEST(AccessTest, AnonymousReadingIsASetting) {
  TestServer server([](server::Config& config) {
    with_tokens(config);
    config.auth.anonymous_read = true;
  });
  EXPECT_EQ(server.get("/tins").status, 200);
  EXPECT_EQ(server.get("/tins", bearer("wrong")).status, 401);
  EXPECT_EQ(server.post_json("/tins", "{}").status, 401);
}

/// A new route is closed unless somebody opened it.
TEST(AccessTest, EveryOperationButTheseNeedsAToken) {
  TestServer server(with_tokens);
  const std::set<std::string> open = {"GET /", "GET /api", "GET /conformance", "GET /healthz", "GET /readyz"};
  for (std::string operation : tests_support::documented_operations()) {
    const std::size_t space = operation.find(' ');
    std::string path = operation.substr(space + 1);
    for (std::size_t at; (at = path.find('{')) != std::string::npos;)
      path.replace(at, path.find('}') - at + 1, "1");
    const RawAnswer answer =
        support::RawClient(server.port())
            .ask(operation.substr(0, space) + " " + path + " HTTP/1.1\r\nHost: t\r\n\r\n");
    EXPECT_EQ(answer.status == 401, !open.contains(operation)) << operation << " " << answer.status;
  }
}

}  // namespace
}  // namespace tests::contract
