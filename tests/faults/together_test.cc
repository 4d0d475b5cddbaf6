// Readers, editors, a simplification and checkpoints at one time, on a store on disk: what the thread
// sanitizer is asked to look at. Every reader sees whole revisions, in order, and the end is the sum of all.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "server/app/simplify.h"
#include "tests/faults/scenario.h"
#include "tests/support/temp_dir.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"

namespace tests::faults {
namespace {

using server::app::Catalogue;
using server::app::Tin;
using server::app::VertexId;
using server::app::WorldEdit;
using tin::terrain::Terrain;

constexpr int kSide = 60, kEditors = 3, kEdits = 60;

Terrain hills() {
  std::vector<tin::terrain::Placement> placements;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) placements.push_back({{x * 1000, y * 1000}, double(x * y % 17)});
  }
  return *Terrain::build({}, placements, tin::terrain::Duplicates::kReject);
}

void read_on(const Tin& tin, const std::atomic<bool>& stop) {
  std::uint64_t last = 0;
  while (!stop) {
    tin.read([&](const Terrain& terrain, std::uint64_t revision) {
      EXPECT_GE(revision, last);
      last = revision;
      tin::query::ElevationQuery query(terrain, tin::query::Voids::kKeep);
      EXPECT_TRUE(query.at({1500, 1500}).has_value());
    });
    static_cast<void>(tin.summary());
  }
}

void read_versions(const Tin& tin, const std::atomic<bool>& stop) {
  while (!stop) {
    const auto version = tin.version();
    const std::string digest = version.terrain->digest();
    EXPECT_EQ(tin::mesh::validate(version.terrain->mesh()), std::nullopt);
    EXPECT_EQ(version.terrain->digest(), digest);
  }
}

void edit(Tin& tin, int editor) {
  for (int i = 0; i < kEdits; ++i) {
    const double x = 10.5 + editor * 8 + 0.01 * i;
    const std::vector<WorldEdit> edits{
        server::app::InsertAt{x, 20.5, double(i)},
        tin::terrain::SetZ{VertexId(1 + static_cast<std::uint64_t>(editor)), i + 100.0}};
    EXPECT_TRUE(tin.edit(edits, {}).ok());
    if (i % 20 == 19) {
      EXPECT_TRUE(
          tin.edit(edits, {{}, {}, server::app::RequestKey{std::to_string(editor * 100 + i), "r"}}).ok());
    }
  }
}

TEST(TogetherTest, ReadersEditorsASimplificationAndCheckpoints) {
  const support::TempDir folder;
  auto store = server::store::open_sqlite_store(folder.path());
  ASSERT_TRUE(store.ok());
  const auto catalogue = std::move(*Catalogue::open(std::move(*store), {}));
  const auto tin = *catalogue->create({"t", "T", hills(), tin::terrain::Duplicates::kReplace, std::nullopt, {}});
  std::atomic<bool> stop{false};
  std::vector<std::thread> others, editors;
  others.emplace_back([&] { read_on(*tin, stop); });
  others.emplace_back([&] { read_versions(*tin, stop); });
  others.emplace_back([&] {
    while (!stop) EXPECT_TRUE(tin->write_checkpoint().ok());
  });
  others.emplace_back([&] {
    tin::base::Progress progress;
    server::app::SimplifyRequest request;
    request.tin = tin;
    request.options.tolerance = 1;
    EXPECT_TRUE(server::app::simplify_tin(*catalogue, request, progress).ok());
  });
  for (int editor = 0; editor < kEditors; ++editor) editors.emplace_back([&, editor] { edit(*tin, editor); });
  for (std::thread& thread : editors) thread.join();
  stop = true;
  for (std::thread& thread : others) thread.join();
  EXPECT_GE(tin->revision(), 1U + kEditors * kEdits);
  const auto version = tin->version();
  EXPECT_EQ(tin::mesh::validate(version.terrain->mesh()), std::nullopt);
  const auto stored = Tin::load(catalogue->store(), "t");
  ASSERT_TRUE(stored.ok()) << stored.error().message;
  EXPECT_EQ(stored->revision, version.revision);
  EXPECT_EQ(stored->terrain.digest(), version.terrain->digest());
}

}  // namespace
}  // namespace tests::faults
