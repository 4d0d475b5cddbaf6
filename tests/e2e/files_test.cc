// tinsmith simplify and tinsmith info: the engine on files, without a server.
#include <chrono>
#include <csignal>
#include <fstream>
#include <limits>
#include <random>
#include <thread>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

namespace fs = std::filesystem;
using support::Finished;

class FilesTest : public ServedTest {
 protected:
  static Finished tinsmith(std::vector<std::string> words) {
    words.insert(words.begin(), TINSMITH_PROGRAM);
    return support::run(words);
  }
  std::string path(const std::string& name) const { return folder_.path() / name; }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  /// Over the DEM's valid pixels; infinite where the other has none.
  static double largest_difference(const Dem& dem, const Dem& other) {
    double largest = 0;
    for (int row = 0; row < dem.height; ++row) {
      for (int column = 0; column < dem.width; ++column) {
        if (!dem.valid(column, row)) continue;
        if (!other.valid(column, row)) return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs(other.value(column, row) - dem.value(column, row)));
      }
    }
    return largest;
  }
  static std::string contents(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Size x size random heights as an ASCII grid: slow to simplify.
  std::string noise(int size, const std::string& cell = "10") const {
    std::mt19937 random(1);
    const std::string file = path("noise.asc");
    std::ofstream out(file);
    out << "ncols " << size << "\nnrows " << size << "\nxllcorner 0\nyllcorner 0\ncellsize " << cell << "\n";
    for (int i = 0; i < size * size; ++i) out << random() % 1000 << ((i + 1) % size == 0 ? '\n' : ' ');
    return file;
  }
};

TEST_F(FilesTest, AGeoTiffOfTheResultIsWithinTheToleranceAtEveryPixel) {
  const Dem dem(sample_file("olinda"));
  const Finished done =
      tinsmith({"simplify", dem.file.string(), "--tolerance", "5", "--output", path("out.tif"), "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.err, "") << "no bar where there is no terminal";
  const Json report = Json::parse(done.out);
  EXPECT_EQ(report.at("samples"), dem.valid_count());
  EXPECT_EQ(report.at("certifiedAgainst"), "original samples");
  EXPECT_EQ(report.at("input"), dem.file.string());
  const Dem out(path("out.tif"));
  EXPECT_EQ(out.geotransform, dem.geotransform);
  const double largest = largest_difference(dem, out);
  EXPECT_LE(largest, 5 + 1e-4);  // pixels are floats
  EXPECT_NEAR(largest, report.at("maxError").get<double>(), 1e-4);
}

TEST_F(FilesTest, TheServerComesToTheSameTriangles) {
  const Dem dem(sample_file("luxembourg"));
  const Finished done = tinsmith({"simplify", dem.file.string(), "-t", "10", "-o", path("out.geojson"),
                                  "--effort", "fast", "--quiet", "--threads", "1"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.out + done.err, "");
  std::ifstream file(path("out.geojson"));
  const Json triangles = Json::parse(file);
  const Misses misses = compare(dem, triangles, 10);
  EXPECT_EQ(misses.beyond + misses.uncovered + misses.strangers, 0U);
  start();
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  const Json result = served_->simplify({{"tin", "dem"}, {"tolerance", 10}, {"effort", "fast"}});
  const Json theirs = served_->get("/tins/dem/export?f=geojson");
  EXPECT_EQ(theirs.at("features").size(), triangles.at("features").size());
  EXPECT_EQ(misses.largest > 0, result.at("maxError") > 0);
}

TEST_F(FilesTest, FilesAreTheServersByteForByte) {
  const std::string feet = noise(40);
  const Json inputs[] = {{{"file", sample_file("luxembourg").string()}, {"crs", "EPSG:4326"}, {"tolerance", "10"}},
                         {{"file", feet}, {"crs", "EPSG:2992"}, {"tolerance", "200"}}};
  const std::pair<const char*, const char*> formats[] = {
      {"out.geojson", "geojson"}, {"out.glb", "glb"}, {"out.ply", "ply"}, {"out.xml", "landxml"}};
  start();
  for (const Json& input : inputs) {
    const std::string file = input.at("file"), crs = input.at("crs"), tolerance = input.at("tolerance");
    ASSERT_EQ(served_->upload("?id=out&effort=fast&tolerance=" + tolerance + "&crs=" + crs, file).status, 201);
    for (const auto& [name, f] : formats) {
      const RawAnswer theirs = served_->http().get(std::string("/tins/out/export?f=") + f);
      const Finished done = tinsmith(
          {"simplify", file, "--crs", crs, "-t", tolerance, "--effort", "fast", "-q", "-o", path(name)});
      ASSERT_EQ(done.status == 0, theirs.status == 200) << name << done.err;
      if (done.status != 0) continue;
      EXPECT_TRUE(contents(path(name)) == theirs.body) << name << " of " << crs;
    }
    served_->http().remove("/tins/out");
  }
  EXPECT_NE(contents(path("out.xml")).find("linearUnit=\"foot\""), std::string::npos);
}

TEST_F(FilesTest, WhatAFormatCannotSayIsRefusedBeforeTheWork) {
  const Finished done = tinsmith({"simplify", noise(700, "0.01"), "--crs", "EPSG:4326", "-t", "1", "--effort", "best",
                                  "--max-seconds", "1000", "-o", path("out.xml")});
  EXPECT_EQ(done.status, 1);
  EXPECT_NE(done.err.find("LandXML"), std::string::npos) << done.err;
  EXPECT_EQ(files(), 1U);
}

TEST_F(FilesTest, ElevationsThatFitPlateausAndTheSurfaceAreOptions) {
  const Dem dem(sample_file("olinda"));
  const auto report = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"simplify", dem.file.string(), "-t", "8", "-o", path("out.tif"), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished done = tinsmith(words);
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_LE(largest_difference(dem, Dem(path("out.tif"))), 8 + 1e-4);  // pixels are floats
    return Json::parse(done.out);
  };
  const Json plain = report({});
  EXPECT_LT(report({"--elevations", "fit"}).at("verticesAfter"), plain.at("verticesAfter"));
  const Json flat = report({"--keep-flat=4"});
  EXPECT_GT(flat.at("levelSamples"), 0);
  EXPECT_EQ(plain.at("levelSamples"), 0);
  EXPECT_LE(report({"--keep-flat"}).at("levelSamples"), flat.at("levelSamples")) << "plateaus of 64 samples and more";
  const Json surface = report({"--against", "surface"});
  EXPECT_GT(surface.at("surfaceCrossings"), 1000);
  EXPECT_GT(surface.at("verticesAfter"), plain.at("verticesAfter"));
}

TEST_F(FilesTest, MeshesHoldTheVerticesAndTrianglesOfTheReport) {
  const std::string input = sample_file("olinda");
  const auto lines_with = [&](const std::string& file, const std::string& head) {
    std::ifstream in(file);
    std::size_t count = 0;
    for (std::string line; std::getline(in, line);) count += line.starts_with(head) ? 1 : 0;
    return count;
  };
  std::size_t vertices = 0;
  for (const char* name : {"out.obj", "out.ply", "out.2dm"}) {
    const Finished done =
        tinsmith({"simplify", input, "-t", "10", "--effort", "fast", "-o", path(name), "--json"});
    ASSERT_EQ(done.status, 0) << done.err;
    vertices = Json::parse(done.out).at("verticesAfter");
  }
  EXPECT_EQ(lines_with(path("out.obj"), "v "), vertices);
  EXPECT_EQ(lines_with(path("out.2dm"), "ND "), vertices);
  EXPECT_EQ(lines_with(path("out.obj"), "f "), lines_with(path("out.2dm"), "E3T "));
  EXPECT_EQ(lines_with(path("out.ply"), "element vertex " + std::to_string(vertices)), 1U);
  // Vertices are those of the file, so a mesh that comes home is a set of points of the same number.
  const Finished info = tinsmith({"info", path("out.obj"), "--json"});
  EXPECT_EQ(Json::parse(info.out).at("samples"), vertices);
}

TEST_F(FilesTest, ABudgetBelowWhatTheToleranceNeedsEndsWithThree) {
  const std::string input = sample_file("olinda");
  const Finished done = tinsmith({"simplify", input, "--tolerance", "1", "--max-vertices", "100", "--effort",
                                  "fast", "--output", path("out.tif"), "--json"});
  EXPECT_EQ(done.status, 3);
  EXPECT_NE(done.err.find("--max-vertices"), std::string::npos);
  const Json report = Json::parse(done.out);
  EXPECT_FALSE(report.at("toleranceMet"));
  EXPECT_LE(report.at("verticesAfter"), 100);
  EXPECT_TRUE(fs::exists(path("out.tif")));
}

TEST_F(FilesTest, WhatIsWrongIsSaidAndNothingIsWritten) {
  const std::string input = sample_file("olinda");
  const auto expect = [&](const std::vector<std::string>& more, int status, const std::string& word) {
    std::vector<std::string> words{"simplify"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished done = tinsmith(words);
    EXPECT_EQ(done.status, status) << word << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_TRUE(done.err.starts_with("tinsmith: ")) << done.err;
    EXPECT_NE(done.err.find(word), std::string::npos) << done.err;
  };
  const std::string out = path("out.tif");
  std::ofstream(out) << "as it was";
  std::ofstream(path("text.txt")) << "no elevations\n";
  expect({input, "-o", out}, 2, "--tolerance or --max-vertices");
  expect({input, "-o", out, "-t", "-1"}, 2, "--tolerance");
  expect({input, "-o", out, "-t", "nan"}, 2, "--tolerance");
  expect({input, "-o", out, "-t", "much"}, 2, "tolerance");
  expect({input, "-o", out, "-t", "1", "--effort", "most"}, 2, "--effort");
  expect({input, "-o", out, "-t", "1", "--elevations", "any"}, 2, "--elevations");
  expect({input, "-o", out, "-t", "1", "--against", "points"}, 2, "--against");
  expect({input, "-o", out, "-t", "1", "--keep-flat=some"}, 2, "keep-flat");
  expect({input, "-o", out, "-t", "1", "--keep-flat=-4"}, 2, "keep-flat");
  expect({input, "-o", out, "-t", "1", "--max-seconds", "0"}, 2, "--max-seconds");
  expect({input, "-o", out, "--max-vertices", "-5"}, 2, "--max-vertices");
  expect({input, "-o", out, "--max-vertices", "2"}, 2, "--max-vertices");
  expect({input, "-o", out, "-t", "1", "--seed", "-1"}, 2, "--seed");
  expect({input, "-o", out, "-t", "1", "--seed", "18446744073709551616"}, 2, "--seed");
  expect({input, "-o", out, "-t", "1", "--threads", "-1"}, 2, "--threads");
  expect({input, "-o", out, "-t", "1", "--duplicates", "most"}, 2, "--duplicates");
  expect({input, "-o", out, "-t", "1", "--class", "300"}, 2, "--class");
  expect({input, "-t", "1"}, 2, "--output");
  expect({input, "-o", path("out.doc"), "-t", "1"}, 2, ".geojson");
  expect({input, "-o", path("no/such/out.tif"), "-t", "1"}, 1, "No such file");
  expect({path("nowhere.tif"), "-o", out, "-t", "1"}, 1, "nowhere.tif");
  expect({path("text.txt"), "-o", out, "-t", "1"}, 1, "text.txt");
  expect({folder_.path(), "-o", out, "-t", "1"}, 1, "folder");
  expect({input, "-o", out, "-t", "1", "--layer", "dem"}, 1, "layers");
  expect({input, "-o", out, "-t", "1", "--crs", "EPSG:1"}, 1, "no coordinate reference system 1");
  std::string text;
  std::getline(std::ifstream(out), text);
  EXPECT_EQ(text, "as it was");
  EXPECT_EQ(files(), 2U);
}

TEST_F(FilesTest, PlacesThatCannotBeWrittenAreRefusedBeforeTheWork) {
  const std::string input = noise(700), dem = path("dem.tif"), scratch = path("no/scratch");
  fs::copy_file(sample_file("olinda"), dem);
  fs::create_directory(path("folder.tif"));
  fs::create_symlink("folder.tif", path("link.tif"));
  fs::create_hard_link(dem, path("same.tif"));
  const auto expect = [&](const std::string& in, const std::string& out, const std::string& word) {
    const Finished done = tinsmith(
        {"simplify", in, "-t", "1", "--effort", "best", "-o", out, "--scratch", word == scratch ? scratch : path("")});
    EXPECT_EQ(done.status, 1) << out;
    EXPECT_NE(done.err.find(word), std::string::npos) << done.err;
  };
  expect(dem, dem, "not overwritten");
  expect(dem, path("same.tif"), "not overwritten");
  expect(input, path("folder.tif"), "folder");
  expect(input, path("link.tif"), "folder");
  expect(input, path(std::string(250, 'n') + ".tif"), "too long");
  expect(input, path("out.tif"), scratch);
  EXPECT_EQ(contents(dem), contents(sample_file("olinda")));
  EXPECT_EQ(files(), 5U);
}

TEST_F(FilesTest, ALinkStaysAndWhatItNamesIsWritten) {
  fs::create_directory(path("there"));
  fs::create_symlink("there/out.ply", path("link.ply"));
  for (int again = 0; again < 2; ++again) {
    const Finished done = tinsmith({"simplify", sample_file("olinda"), "-t", "10", "-q", "-o", path("link.ply")});
    ASSERT_EQ(done.status, 0) << done.err;
    EXPECT_TRUE(fs::is_symlink(path("link.ply")));
    EXPECT_TRUE(contents(path("there/out.ply")).starts_with("ply"));
    EXPECT_EQ(files(), 2U);
  }
}

TEST_F(FilesTest, AWriteThatFailsSaysWhy) {
  const std::string command = "trap '' XFSZ; ulimit -f 1; exec " + std::string(TINSMITH_PROGRAM) + " simplify " +
                              sample_file("olinda").string() + " --effort fast -t 1 -q -o " + folder_.path().string();
  for (const char* name : {"/out.geojson", "/out.ply"}) {
    const Finished done = support::run({"sh", "-c", command + name});
    EXPECT_EQ(done.status, 1);
    EXPECT_NE(done.err.find("File too large"), std::string::npos) << done.err;
  }
  EXPECT_EQ(files(), 0U);
}

TEST_F(FilesTest, AReportThatCannotBeWrittenIsAnError) {
  const std::string program = TINSMITH_PROGRAM, input = sample_file("olinda");
  for (const std::string& command : {" info " + input, " simplify " + input + " -t 9 -o " + path("out.ply")}) {
    for (const char* json : {"", " --json"}) {
      const Finished done = support::run({"sh", "-c", program + command + json + " > /dev/full"});
      EXPECT_EQ(done.status, 1) << command << json;
      EXPECT_NE(done.err.find("standard output"), std::string::npos) << done.err;
    }
  }
}

TEST_F(FilesTest, WhatIsReplacedKeepsItsPermissions) {
  std::ofstream(path("out.ply")) << "as it was";
  fs::permissions(path("out.ply"), fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_EQ(tinsmith({"simplify", sample_file("olinda"), "-t", "9", "-q", "-o", path("out.ply")}).status, 0);
  EXPECT_TRUE(contents(path("out.ply")).starts_with("ply"));
  EXPECT_EQ(fs::status(path("out.ply")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FilesTest, ASignalStopsItWithinASecondAndLeavesNothing) {
  const std::string input = noise(700);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    support::Child child(
        {TINSMITH_PROGRAM, "simplify", input, "-t", "1", "--effort", "best", "-o", path("out.tif")},
        path("err.txt"));
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    const auto asked = std::chrono::steady_clock::now();
    child.signal(number);
    EXPECT_EQ(child.wait(), 128 + number);
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(3))
        << "a second, on a machine at rest";
    EXPECT_EQ(files(), 2U) << "the input and what was said";
  }
}

TEST_F(FilesTest, ReportsNameTheCrsTheUnitAndTheBandsThatAreNotRead) {
  const std::string dem = sample_file("olinda"), two = path("two.tif");
  ASSERT_EQ(support::run({"gdal_translate", "-q", "-b", "1", "-b", "1", dem, two}).status, 0);
  const std::vector<std::string> words{"simplify", two, "-t", "10", "-o", path("out.ply")};
  auto as_json = words;
  as_json.push_back("--json");
  const std::string text = tinsmith(as_json).out;
  EXPECT_EQ(text.find("\"crs\""), text.rfind("\"crs\"")) << "once";
  const Json report = Json::parse(text), info = Json::parse(tinsmith({"info", two, "--json"}).out);
  EXPECT_EQ(report.at("crs"), info.at("crs"));
  EXPECT_EQ(report.at("verticalUnit"), info.at("verticalUnit"));
  EXPECT_EQ(info.at("bands"), 2);
  EXPECT_NE(tinsmith(words).out.find("first of 2 bands"), std::string::npos);
  EXPECT_NE(tinsmith({"info", two}).out.find("Bands: 2"), std::string::npos);
  const Finished bare = tinsmith({"simplify", noise(20), "-t", "10", "-o", path("out.ply")});
  EXPECT_NE(bare.out.find("in the file's own unit"), std::string::npos) << bare.out;
}

TEST_F(FilesTest, TheContentOfPointsIsSaidAsToTheServer) {
  std::ofstream(path("points.csv")) << "x,y,depth\n0,0,3\n9,0,4\n0,9,5\n9,0,6\n";
  EXPECT_EQ(tinsmith({"info", path("points.csv"), "--z-field", "none"}).status, 1);
  const Finished info = tinsmith({"info", path("points.csv"), "--z-field", "depth", "--json"});
  EXPECT_EQ(Json::parse(info.out).at("zRange"), Json::array({3, 6})) << info.err;
  for (const auto& [duplicates, status] : {std::pair("reject", 1), std::pair("min", 0)}) {
    const Finished done = tinsmith({"simplify", path("points.csv"), "--z-field", "depth", "-t", "0", "-q", "-o",
                                    path("out.ply"), "--duplicates", duplicates});
    EXPECT_EQ(done.status, status) << done.err;
  }
}

TEST_F(FilesTest, InfoSaysWhatARasterIs) {
  const Dem dem(sample_file("luxembourg"));
  const Finished said = tinsmith({"info", dem.file.string(), "--json"});
  ASSERT_EQ(said.status, 0) << said.err;
  const Json info = Json::parse(said.out);
  EXPECT_EQ(info.at("kind"), "raster");
  EXPECT_EQ(info.at("format"), "GTiff");
  EXPECT_EQ(info.at("crs"), "EPSG:4326");
  EXPECT_EQ(info.at("width"), dem.width);
  EXPECT_EQ(info.at("height"), dem.height);
  EXPECT_EQ(info.at("nodata"), *dem.nodata);
  EXPECT_EQ(info.at("samples"), dem.valid_count());
  EXPECT_EQ(info.at("geotransform").get<std::vector<double>>(),
            std::vector<double>(dem.geotransform.begin(), dem.geotransform.end()));
  double low = 1e300, high = -1e300;
  for (const double z : dem.values) {
    if (z == *dem.nodata) continue;
    low = std::min(low, z);
    high = std::max(high, z);
  }
  EXPECT_EQ(info.at("zRange"), Json::array({low, high}));
  const Finished text = tinsmith({"info", dem.file.string()});
  EXPECT_NE(text.out.find("Size: " + std::to_string(dem.width) + " x " + std::to_string(dem.height)),
            std::string::npos);
}

TEST_F(FilesTest, InfoSaysWhatPointsAreAndRefusesTheRest) {
  std::ofstream(path("points.csv")) << "x,y,z\n1,2,3\n4,8,-1.5\n";
  const Finished said = tinsmith({"info", path("points.csv"), "--crs", "EPSG:32725", "--json"});
  ASSERT_EQ(said.status, 0) << said.err;
  const Json info = Json::parse(said.out);
  EXPECT_EQ(info.at("kind"), "points");
  EXPECT_EQ(info.at("samples"), 2);
  EXPECT_EQ(info.at("crs"), "EPSG:32725");
  EXPECT_EQ(info.at("xRange"), Json::array({1, 4}));
  EXPECT_EQ(info.at("zRange"), Json::array({-1.5, 3}));
  EXPECT_EQ(tinsmith({"info", path("nowhere")}).status, 1);
  EXPECT_EQ(tinsmith({"info"}).status, 2);
}

}  // namespace
}  // namespace tests::e2e
