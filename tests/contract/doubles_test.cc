// Elevations as doubles: the same numbers as in JSON.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

std::string bytes_of(const std::vector<double>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

std::vector<double> numbers_of(const std::string& bytes) {
  EXPECT_EQ(bytes.size() % sizeof(double), 0U);
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  return numbers;
}

class DoublesTest : public testing::Test {
 protected:
  RawAnswer ask(const std::vector<double>& positions, const std::string& query = "") {
    return server_.upload("/tins/t/elevation" + query, "application/octet-stream", bytes_of(positions));
  }
  void SetUp() override {
    ASSERT_EQ(server_.upload("/tins?id=t", "text/plain", ascii_grid(20, 15)).status, 201);
  }
  TestServer server_{[](server::Config& config) { config.limits.positions_per_request = 300; }};
};

TEST_F(DoublesTest, AreThoseOfJson) {
  std::vector<double> positions;
  Json list = Json::array();
  for (int i = 0; i < 200; ++i) {
    const double x = std::fmod(i * 7.31, 22) - 1, y = std::fmod(i * 3.77, 17) - 1;
    positions.insert(positions.end(), {x, y});
    list.push_back({x, y});
  }
  const RawAnswer answer = ask(positions);
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.header("content-type"), "application/octet-stream");
  EXPECT_NE(answer.header("etag"), "");
  const auto z = numbers_of(answer.body);
  const Json expected =
      Json::parse(server_.post_json("/tins/t/elevation", Json{{"positions", list}}.dump()).body).at("z");
  ASSERT_EQ(z.size(), expected.size());
  int outside = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (expected[i].is_null()) {
      EXPECT_TRUE(std::isnan(z[i])) << i;
      ++outside;
    } else {
      EXPECT_EQ(z[i], expected[i].get<double>()) << i;
    }
  }
  EXPECT_GT(outside, 0);
  EXPECT_LT(outside, 150);
}

TEST_F(DoublesTest, NoneIsNoError) {
  const RawAnswer answer = server_.upload("/tins/t/elevation", "application/octet-stream", "");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "");
}

TEST_F(DoublesTest, BadOnesAreNamed) {
  EXPECT_EQ(slug(ask({1, 2, 3})), "malformed");
  EXPECT_EQ(slug(server_.upload("/tins/t/elevation", "application/octet-stream", "1234567")), "malformed");
  const RawAnswer nan = ask({1, 2, NAN, 4});
  EXPECT_EQ(slug(nan), "not-finite");
  EXPECT_EQ(Json::parse(nan.body).at("where"), "/1");
  EXPECT_EQ(slug(ask({1, INFINITY})), "not-finite");
  EXPECT_EQ(slug(ask({1, 2}, "?voids=maybe")), "invalid-value");
  EXPECT_EQ(ask({1e308, -1e308}).status, 200) << "outside is no error";
}

TEST_F(DoublesTest, TheLimitIsThatOfPositions) {
  EXPECT_EQ(ask(std::vector<double>(600, 1.0)).status, 200);
  EXPECT_EQ(slug(ask(std::vector<double>(602, 1.0))), "too-large");
}

TEST_F(DoublesTest, ParametersOfTheQueryAreForThemOnly) {
  EXPECT_EQ(ask({1, 2}, "?voids=fill").status, 200);
  EXPECT_EQ(slug(server_.post_json("/tins/t/elevation?voids=fill", R"({"positions":[[1,2]]})")),
            "unknown-parameter");
}

}  // namespace
}  // namespace tests::contract
