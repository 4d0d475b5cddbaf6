// The table of routes and proto/openapi.json, each against the other.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/api/routes.h"
#include "server/store/sqlite_store.h"
#include "tests/contract/contract.h"
#include "tests/support/schema_check.h"
#include "tests/support/temp_dir.h"

namespace tests::contract {
namespace {

class RouterContractTest : public testing::Test {
 protected:
  RouterContractTest() {
    auto store = server::store::open_sqlite_store(folder_.path());
    catalogue_ = std::move(*server::app::Catalogue::open(std::move(*store), config_.limits));
    context_.reset(new server::api::Context{*catalogue_, jobs_, config_});
    router_ = server::api::make_router(*context_);
  }
  static std::string operation(const server::http::Route& route) {
    return std::string(server::http::method_name(route.method)) + " " + route.pattern;
  }

  support::TempDir folder_;
  server::Config config_;
  server::jobs::JobQueue jobs_{{}};
  std::unique_ptr<server::app::Catalogue> catalogue_;
  std::unique_ptr<server::api::Context> context_;
  server::http::Router router_;
};

TEST_F(RouterContractTest, EveryRouteIsDocumentedAndEveryOperationIsRouted) {
  std::set<std::string> routed;
  for (const auto& route : router_.routes()) routed.insert(operation(route));
  const auto operations = tests_support::documented_operations();
  EXPECT_EQ(routed, std::set<std::string>(operations.begin(), operations.end()));
}

TEST_F(RouterContractTest, EachRouteKnowsExactlyItsDocumentedQueryParameters) {
  for (const auto& route : router_.routes()) {
    EXPECT_EQ(std::set<std::string>(route.query.begin(), route.query.end()),
              documented_query(operation(route)))
        << operation(route);
  }
}

TEST_F(RouterContractTest, TheParametersInAPathAreDocumentedUnderTheirNames) {
  for (const auto& route : router_.routes()) {
    std::set<std::string> names;
    for (std::size_t at = route.pattern.find('{'); at != std::string::npos;
         at = route.pattern.find('{', at + 1)) {
      names.insert(route.pattern.substr(at + 1, route.pattern.find('}', at) - at - 1));
    }
    EXPECT_EQ(names, documented_path_parameters(operation(route))) << operation(route);
  }
}

TEST_F(RouterContractTest, ARouteTakesABodyExactlyWhereOneIsDocumented) {
  for (const auto& route : router_.routes()) {
    EXPECT_EQ(route.body != server::http::BodyKind::kNone, documents_a_body(operation(route)))
        << operation(route);
  }
}

}  // namespace
}  // namespace tests::contract
