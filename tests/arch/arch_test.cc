// Holds the #include lines of the tree against arrows.txt and libraries.txt, and the checker against planted
// breaks.

#include <gtest/gtest.h>

#include "tests/arch/arrows.h"

namespace {

const std::filesystem::path kRoot = TINSMITH_SOURCE_DIR;

const arch::Rules& rules() {
  static const arch::Rules read(arch::read_text(kRoot / "tests/arch/arrows.txt"),
                                arch::read_text(kRoot / "tests/arch/libraries.txt"));
  return read;
}

bool allowed(const std::string& file, const std::string& line) {
  const auto includes = arch::includes_of(line);
  EXPECT_EQ(includes.size(), 1u) << line;
  return includes.size() == 1 && rules().objection(file, includes[0]).empty();
}

TEST(ArrowsTest, TheTreeFollowsThem) {
  const auto files = arch::sources_below(kRoot, {"tin", "proto", "server"});
  EXPECT_GT(files.size(), 20u);
  for (const auto& file : files) {
    EXPECT_NE(rules().room_of(file), "") << file << " lies in a room that has no line in arrows.txt";
    for (const auto& include : arch::includes_of(arch::read_text(kRoot / file))) {
      const auto objection = rules().objection(file, include);
      EXPECT_EQ(objection, "") << file << ":" << include.line << ": " << include.header << " " << objection;
    }
  }
}

TEST(ArrowsTest, TheTableHasNoCycle) {
  EXPECT_EQ(rules().cycle(), std::vector<std::string>{});
  EXPECT_EQ(arch::Rules("a: b\nb: c\nc: b\n", "").cycle(), (std::vector<std::string>{"b", "c", "b"}));
}

TEST(ArrowsTest, AnUpwardIncludeIsFound) {
  EXPECT_FALSE(allowed("tin/mesh/mesh.cc", "#include \"tin/delaunay/triangulation.h\""));
  EXPECT_FALSE(allowed("tin/base/check.h", "#include \"tin/exact/point.h\""));
  EXPECT_FALSE(allowed("tin/frame/frame.cc", "#include \"tin/mesh/mesh.h\""));
  EXPECT_FALSE(allowed("tin/query/elevation.cc", "#include \"tin/simplify/greedy.h\""));
  EXPECT_FALSE(allowed("tin/terrain/terrain.cc", "#include \"proto/messages.h\""));
  EXPECT_FALSE(allowed("proto/messages.h", "#include \"server/app/catalogue.h\""));
  EXPECT_FALSE(allowed("proto/messages.h", "#include \"proto/formats/geojson.h\""));
  EXPECT_FALSE(allowed("proto/messages.h", "#include \"tin/codec/checkpoint.h\""));
  EXPECT_FALSE(allowed("server/store/sqlite.cc", "#include \"server/app/catalogue.h\""));
  EXPECT_FALSE(allowed("server/http/session.cc", "#include \"tin/mesh/mesh.h\""));
  EXPECT_FALSE(allowed("server/api/tins.cc", "#include \"server/store/store.h\""));
  EXPECT_FALSE(allowed("server/app/catalogue.cc", "#include \"server/main.h\""));
  EXPECT_FALSE(allowed("server/strange.cc", "#include \"tin/base/result.h\""));
}

TEST(ArrowsTest, ADownwardIncludeIsAllowed) {
  EXPECT_TRUE(allowed("tin/mesh/mesh.cc", "#include \"tin/mesh/mesh.h\""));
  EXPECT_TRUE(allowed("tin/terrain/terrain.cc", "#include \"tin/base/result.h\""));
  EXPECT_TRUE(allowed("tin/simplify/greedy.cc", "#include \"tin/query/elevation.h\""));
  EXPECT_TRUE(allowed("proto/formats/geojson.cc", "#include \"tin/mesh/mesh.h\""));
  EXPECT_TRUE(allowed("server/api/tins.cc", "#include \"tin/terrain/terrain.h\""));
  EXPECT_TRUE(allowed("server/app/catalogue.cc", "#include \"server/config.h\""));
  EXPECT_TRUE(allowed("server/main.cc", "#include \"server/cli/serve.h\""));
}

TEST(ArrowsTest, ALibraryStaysInItsRoom) {
  EXPECT_TRUE(allowed("server/http/session.cc", "#include <boost/beast.hpp>"));
  EXPECT_FALSE(allowed("server/http/session.h", "#include <boost/beast.hpp>"));
  EXPECT_FALSE(allowed("server/api/tins.cc", "#include <gdal_priv.h>"));
  EXPECT_FALSE(allowed("server/api/tins.cc", "#include <nlohmann/json.hpp>"));
  EXPECT_TRUE(allowed("server/config.cc", "#include <nlohmann/json.hpp>"));
  EXPECT_TRUE(allowed("tin/mesh/validate.cc", "#include <gmpxx.h>"));
  EXPECT_FALSE(allowed("tin/mesh/mesh.cc", "#include <gmpxx.h>"));
  EXPECT_FALSE(allowed("tin/terrain/terrain.cc", "#include <GeographicLib/Geodesic.hpp>"));
  EXPECT_FALSE(allowed("server/app/catalogue.cc", "#include <sqlite3.h>"));
  EXPECT_FALSE(allowed("tin/base/progress.h", "#include <chrono>"));
  EXPECT_FALSE(allowed("tin/codec/checkpoint.cc", "#include <fstream>"));
  EXPECT_TRUE(allowed("tin/codec/checkpoint.cc", "#include <vector>"));
}

TEST(ArrowsTest, OurHeadersAreNamedFromTheRootInQuotes) {
  EXPECT_FALSE(allowed("tin/mesh/mesh.cc", "#include \"mesh.h\""));
  EXPECT_FALSE(allowed("tin/mesh/mesh.cc", "#include <tin/mesh/mesh.h>"));
  EXPECT_FALSE(allowed("tin/mesh/mesh.cc", "#include \"../base/check.h\""));
}

TEST(ArrowsTest, CommentsAreNoIncludes) {
  EXPECT_TRUE(arch::includes_of("// #include \"a.h\"\n/* one\n#include \"b.h\"\n*/\n").empty());
  const auto includes = arch::includes_of("/* all */ // of it /*\n  #  include <c.h>  // why\n");
  ASSERT_EQ(includes.size(), 1u);
  EXPECT_EQ(includes[0].header, "c.h");
  EXPECT_EQ(includes[0].line, 2);
  EXPECT_FALSE(includes[0].quoted);
}

TEST(ArrowsTest, AWrongTableIsRefused) {
  EXPECT_THROW(arch::Rules("tin/base", ""), std::runtime_error);
  EXPECT_THROW(arch::Rules("a: b\n", ""), std::runtime_error);
  EXPECT_THROW(arch::Rules("a:\na:\n", ""), std::runtime_error);
}

}  // namespace
