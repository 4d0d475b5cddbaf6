#include "proto/openapi.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "proto/messages.h"
#include "tests/support/schema_check.h"

namespace {

using tests_support::request_violations;
using tests_support::schema_violations;
using tests_support::violations;

TEST(OpenApiTest, TheProgramHoldsTheFileByteForByte) {
  std::ifstream file(OPENAPI_FILE, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(proto::openapi_json(), text.str());
}

TEST(OpenApiTest, EveryExampleFitsItsSchema) {
  for (const std::string& line : tests_support::example_violations()) ADD_FAILURE() << line;
}

TEST(OpenApiTest, TheDocumentDescribesItself) {
  EXPECT_TRUE(violations("GET", "/api", 200, proto::openapi_json()).empty());
}

TEST(OpenApiTest, ExamplesOfRequestsCanBeRead) {
  const char* create =
      R"({"id":"hill","crs":"EPSG:32617","resolution":0.001,"vertices":[[500000,4500000,10]]})";
  EXPECT_TRUE(request_violations("POST", "/tins", create).empty());
  EXPECT_TRUE(proto::read_create_tin(create, 10).ok());
  const char* edit = R"({"ops":[{"op":"insert","x":1,"y":2,"z":3},{"op":"set-z","id":1,"z":4}]})";
  EXPECT_TRUE(request_violations("POST", "/tins/{tin}/edits", edit).empty());
  EXPECT_TRUE(proto::read_edit_request(edit, {10, 3, 100}).ok());
}

/// What the checker finds, the reader refuses too.
TEST(SchemaCheckTest, SeesWhatIsWrong) {
  EXPECT_FALSE(schema_violations("Health", R"({"status":"ok"})").empty());
  EXPECT_FALSE(schema_violations("Health", R"({"status":"well","version":"1"})").empty());
  EXPECT_FALSE(schema_violations("Health", R"({"status":"ok","version":"1","more":1})").empty());
  EXPECT_FALSE(schema_violations("Health", "{").empty());
  EXPECT_FALSE(schema_violations("Nothing", "{}").empty());
  EXPECT_TRUE(schema_violations("Elevation", R"({"z":null,"triangle":null,"revision":0})").empty());
  EXPECT_FALSE(schema_violations("Elevation", R"({"z":null,"triangle":[1,2],"revision":0})").empty());
  EXPECT_FALSE(schema_violations("Elevation", R"({"z":null,"triangle":null,"revision":null})").empty());
  EXPECT_FALSE(violations("GET", "/nowhere", 200, "{}").empty());
  EXPECT_FALSE(violations("PUT", "/tins", 200, "{}").empty());
  EXPECT_FALSE(violations("GET", "/tins", 204, "").empty());
  EXPECT_FALSE(violations("DELETE", "/tins/{tin}", 204, "{}").empty());
  EXPECT_TRUE(violations("DELETE", "/tins/{tin}", 204, "").empty());
  EXPECT_FALSE(violations("GET", "/tins", 418, R"({"status":418})").empty());
  EXPECT_TRUE(violations("GET", "/tins", 418, R"({"type":"/problems/x","title":"x","status":418})").empty());
  for (const char* body :
       {R"({"ops":[{"op":"insert","x":1,"y":2}]})", R"({"ops":[{"op":"fly"}]})",
        R"({"ops":[{"op":"remove","id":0}]})", R"({"ops":[{"op":"remove","id":1,"z":2}]})", R"({"op":[]})"}) {
    EXPECT_FALSE(request_violations("POST", "/tins/{tin}/edits", body).empty()) << body;
    EXPECT_FALSE(proto::read_edit_request(body, {10, 3, 100}).ok()) << body;
  }
}

}  // namespace
