#include <fstream>

#include "proto/formats/byte_reader.h"
#include "server/gdal/delimited_internal.h"
#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;

class DelimitedTest : public ScratchTest {
 protected:
  Import read(std::string_view content, const ImportOptions& options = {}) const {
    return imported(file("upload", content), options);
  }
  tin::base::Error refuse(std::string_view content, const ImportOptions& options = {}) const {
    return import_error(file("upload", content), options);
  }
  /// Expects the points (1.5, 2, 3) and (-4, 5, 60).
  void expect_two(std::string_view content, const ImportOptions& options = {}) const {
    const Import import = read(content, options);
    ASSERT_EQ(import.placements.size(), 2U) << content;
    EXPECT_EQ(import.driver, "CSV");
    EXPECT_EQ(import.frame.x.world(import.placements[0].at.x), 1.5) << content;
    EXPECT_EQ(import.frame.y.world(import.placements[0].at.y), 2) << content;
    EXPECT_EQ(import.placements[0].z, 3) << content;
    EXPECT_EQ(import.frame.x.world(import.placements[1].at.x), -4) << content;
    EXPECT_EQ(import.frame.y.world(import.placements[1].at.y), 5) << content;
    EXPECT_EQ(import.placements[1].z, 60) << content;
  }
};

TEST_F(DelimitedTest, TakesEveryUsualDelimiter) {
  expect_two("x,y,z\n1.5,2,3\n-4,5,6e1\n");
  expect_two("1.5,2,3\r\n-4,5,60\r\n");
  expect_two("1.5;2;3\n-4;5;60");
  expect_two("x;y;z\n1,5;2;3\n-4;5;60");  // decimal commas
  expect_two("1,5;2;3\n-4;5;60");
  expect_two("1.5\t2\t3\n-4\t5\t60\n");
  expect_two("1.5 2 3\n-4 5 60\n");
  expect_two("   1.5    2  3  \n  -4   5 60\n");
  expect_two("\xEF\xBB\xBFx, y, z\n +1.5, 2, 3\n -4, 5, 60\n\n");
  expect_two("# survey\n// of today\nx y z\n\n1.5 2 3\n-4 5 60\n");
  expect_two("\"x\",\"y\",\"z\"\n\"1.5\",\"2\",\"3\"\n-4,5,60\n");
}

TEST_F(DelimitedTest, FindsColumnsByName) {
  expect_two("id,Z,northing,EASTING\n7,3,2,1.5\n8,60,5,-4\n");
  expect_two("name,x,y,depth,height\n\"a, b\",1.5,2,0,3\nc,-4,5,0,60\n");
  ImportOptions options;
  options.z_field = "Depth";
  expect_two("x,y,z,depth\n1.5,2,0,3\n-4,5,0,60\n", options);
}

TEST_F(DelimitedTest, TakesTheFirstThreeNumericColumnsOtherwise) {
  expect_two("p1,1.5,2,3,red\np2,-4,5,60,blue\n");
  expect_two("Rechts,Hoch,Wert\n1.5,2,3\n-4,5,60\n");
}

TEST_F(DelimitedTest, LongitudesAndLatitudesAreDegrees) {
  const Import import = read("lat,lon,alt\n47.5,8.25,500\n47.6,8.5,510\n");
  EXPECT_EQ(import.frame.crs, "EPSG:4326");
  EXPECT_EQ(import.placements[0].at, import.frame.to_lattice(8.25, 47.5).value());
  ImportOptions options;
  options.crs = "EPSG:4258";
  EXPECT_EQ(read("lat,lon,alt\n47.5,8.25,500\n47.6,8.5,510\n", options).frame.crs, "EPSG:4258");
}

TEST_F(DelimitedTest, NamesTheLineThatIsWrong) {
  auto problem = refuse("x,y,z\n1,2,3\n1,two,3\n");
  EXPECT_EQ(problem.code, Code::kMalformed);
  EXPECT_EQ(problem.where, "line 3");
  EXPECT_EQ(refuse("x,y,z\n1,2,3\n1,2\n").where, "line 3");
  EXPECT_EQ(refuse("1,2,3\n1,2,\n").code, Code::kMalformed);
  problem = refuse("x y z\n\n1 2 nan\n");
  EXPECT_EQ(problem.code, Code::kNotFinite);
  EXPECT_EQ(problem.where, "line 3");
  EXPECT_EQ(refuse("x,y,z\n1,-inf,3\n").code, Code::kNotFinite);
  EXPECT_EQ(refuse("x,y,z\n1,1e999,3\n").code, Code::kNotFinite);
  EXPECT_EQ(refuse("x,y,z\n1,1e300,3\n").code, Code::kInvalidValue);
}

TEST_F(DelimitedTest, RefusesFilesWithoutPoints) {
  EXPECT_EQ(refuse("It was the best of times,\nit was the worst of times\n").code, Code::kMalformed);
  EXPECT_EQ(refuse("one line of prose").code, Code::kInvalidValue);
  EXPECT_EQ(refuse("x,y,z\n").code, Code::kInvalidValue);
  EXPECT_EQ(refuse("a,b\n1,2\n").code, Code::kMalformed);
  EXPECT_EQ(refuse("x,y,colour\n1,2,3\n").code, Code::kInvalidValue);
  EXPECT_EQ(refuse("x,z\n1,2\n").code, Code::kInvalidValue);
  EXPECT_EQ(refuse("   \n \n").code, Code::kUnsupported);
  ImportOptions options;
  options.z_field = "w";
  EXPECT_EQ(refuse("x,y,z\n1,2,3\n", options).where, "query:z-field");
  EXPECT_EQ(refuse("1,2,3\n", options).where, "query:z-field");
}

TEST_F(DelimitedTest, HoldsItsLimits) {
  ImportOptions options;
  options.max_samples = 2;
  EXPECT_EQ(read("1 2 3\n4 5 6\n", options).placements.size(), 2U);
  options.max_samples = 1;
  EXPECT_EQ(refuse("1 2 3\n4 5 6\n", options).code, Code::kTooLarge);
  EXPECT_EQ(refuse("1 2 3\n" + std::string(proto::formats::LineReader::kLongestLine + 1, ' ')).code,
            Code::kMalformed);
}

TEST_F(DelimitedTest, ManyPointsKeepTheirOrderAndCanBeCancelled) {
  std::string content = "x,y,z\n";
  for (int i = 0; i < 200000; ++i) {
    content += std::to_string(i % 500) + "," + std::to_string(i / 500) + "," + std::to_string(i) + "\n";
  }
  const Import import = read(content);
  ASSERT_EQ(import.placements.size(), 200000U);
  for (std::size_t i = 0; i < import.placements.size(); ++i)
    ASSERT_EQ(import.placements[i].z, static_cast<double>(i));
  tin::base::Progress progress;
  progress.cancel();
  EXPECT_EQ(import_file(path("upload"), {}, &progress).error().code, Code::kCancelled);
}

TEST_F(DelimitedTest, TheResolutionCanBeChosen) {
  ImportOptions options;
  options.resolution_x = options.resolution_y = 0.5;
  expect_two("1.6,2.1,3\n-4.2,5,60\n", options);
  options.resolution_x = 1e-9;
  options.resolution_y = 1e-9;
  EXPECT_EQ(refuse("1.5,2,3\n-4,5,60\n", options).code, Code::kInvalidValue);
}

TEST(LineReaderTest, JoinsLinesAcrossItsBuffer) {
  const std::filesystem::path name = ::testing::TempDir() + "/tinsmith-lines";
  {
    std::ofstream out(name);
    for (int i = 0; i < 300000; ++i) out << "line " << i << "\n";
    out << "last";
  }
  proto::formats::FileReader file(name);
  proto::formats::LineReader lines(file);
  for (int i = 0; i < 300000; ++i) {
    const auto line = lines.next();
    ASSERT_TRUE(line.has_value());
    ASSERT_EQ(*line, "line " + std::to_string(i));
  }
  EXPECT_EQ(lines.next(), "last");
  EXPECT_EQ(lines.number(), 300001U);
  EXPECT_FALSE(lines.next().has_value());
  EXPECT_FALSE(lines.failed());
  std::filesystem::remove(name);
}

}  // namespace
}  // namespace server::gdal::testing
