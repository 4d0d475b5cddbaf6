#include "server/http/router.h"

#include <gtest/gtest.h>

namespace tests::server_http {
namespace {

using server::http::allow_list;
using server::http::check_query;
using server::http::Method;
using server::http::Request;
using server::http::Response;
using server::http::Route;
using server::http::RouteMatch;
using server::http::Router;
using tin::base::Code;

Route route(Method method, std::string pattern) {
  Route made;
  made.method = method;
  made.pattern = std::move(pattern);
  made.query = {"limit", "crs"};
  made.handler = [](Request&) { return Response(); };
  return made;
}

class RouterTest : public testing::Test {
 protected:
  RouterTest() {
    router_.add(route(Method::kGet, "/"));
    router_.add(route(Method::kGet, "/tins"));
    router_.add(route(Method::kPost, "/tins"));
    router_.add(route(Method::kGet, "/tins/{tin}"));
    router_.add(route(Method::kPost, "/tins/{tin}/edits"));
    router_.add(route(Method::kGet, "/tins/{tin}/collections/{name}"));
    router_.add(route(Method::kGet, "/tins/{tin}/collections/surface"));
    router_.add(route(Method::kPut, "/tins/{tin}/collections/{name}"));
    router_.add(route(Method::kGet, "/dem/{z}/{x}/{y}.png"));
    router_.add(route(Method::kGet, "/dem/{z}/{x}/{y}.terrain"));
  }

  std::string pattern(Method method, const std::vector<std::string>& segments) const {
    const RouteMatch match = router_.match(method, segments);
    return match.route == nullptr ? "none" : match.route->pattern;
  }

  Router router_;
};

TEST_F(RouterTest, ParametersAreNamed) {
  const RouteMatch match = router_.match(Method::kGet, {"tins", "a/b", "collections", "vertices"});
  ASSERT_NE(match.route, nullptr);
  EXPECT_EQ(match.path_parameters.at("tin"), "a/b");
  EXPECT_EQ(match.path_parameters.at("name"), "vertices");
}

TEST_F(RouterTest, LiteralsWinOverParameters) {
  EXPECT_EQ(pattern(Method::kGet, {"tins", "a", "collections", "surface"}),
            "/tins/{tin}/collections/surface");
  EXPECT_EQ(pattern(Method::kPut, {"tins", "a", "collections", "surface"}), "/tins/{tin}/collections/{name}");
}

TEST_F(RouterTest, ASegmentMayHaveTextAroundItsParameter) {
  EXPECT_EQ(pattern(Method::kGet, {"dem", "1", "2", "3.png"}), "/dem/{z}/{x}/{y}.png");
  EXPECT_EQ(router_.match(Method::kGet, {"dem", "1", "2", "3.terrain"}).path_parameters.at("y"), "3");
  EXPECT_EQ(pattern(Method::kGet, {"dem", "1", "2", ".png"}), "none");
  EXPECT_EQ(pattern(Method::kGet, {"dem", "1", "2", "3.gif"}), "none");
}

TEST_F(RouterTest, EmptySegmentsFitNoParameter) {
  EXPECT_EQ(pattern(Method::kGet, {""}), "/");
  EXPECT_EQ(pattern(Method::kGet, {"tins", ""}), "none");
  EXPECT_TRUE(router_.match(Method::kGet, {"tins", ""}).allowed.empty());
}

TEST_F(RouterTest, HeadIsServedByGet) {
  EXPECT_EQ(pattern(Method::kHead, {"tins"}), "/tins");
  EXPECT_EQ(pattern(Method::kHead, {"tins", "a", "edits"}), "none");
}

TEST_F(RouterTest, AKnownPathSaysWhatItAllows) {
  EXPECT_EQ(allow_list(router_.match(Method::kDelete, {"tins"}).allowed), "GET, HEAD, POST, OPTIONS");
  EXPECT_EQ(allow_list(router_.match(Method::kGet, {"tins", "a", "edits"}).allowed), "POST, OPTIONS");
  EXPECT_EQ(allow_list(router_.match(Method::kPost, {"tins", "a", "collections", "surface"}).allowed),
            "GET, HEAD, PUT, OPTIONS");
}

TEST_F(RouterTest, TheTableCanBeListed) {
  EXPECT_EQ(router_.routes().size(), 10U);
  EXPECT_EQ(router_.routes()[4].pattern, "/tins/{tin}/edits");
}

TEST_F(RouterTest, QueryParametersMustBeKnownAndSingle) {
  const Route& listing = router_.routes()[1];
  EXPECT_TRUE(check_query(listing, {{"crs", "x"}, {"limit", "1"}}));
  const auto unknown = check_query(listing, {{"limt", "1"}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Code::kUnknownParameter);
  EXPECT_EQ(unknown.error().where, "query:limt");
  const auto doubled = check_query(listing, {{"limit", "1"}, {"crs", "x"}, {"limit", "1"}});
  ASSERT_FALSE(doubled);
  EXPECT_EQ(doubled.error().code, Code::kMalformed);
  EXPECT_EQ(doubled.error().where, "query:limit");
}

using RouterDeathTest = RouterTest;

TEST_F(RouterDeathTest, TwoRoutesOfOneShapeAreABug) {
  EXPECT_DEATH(router_.add(route(Method::kGet, "/tins/{other}")), "");
  EXPECT_DEATH(router_.add(route(Method::kHead, "/x")), "");
}

}  // namespace
}  // namespace tests::server_http
