#include "server/app/tin.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "server/app/catalogue.h"
#include "server/app/source.h"
#include "server/store/store.h"
#include "tests/server/app/failing_store.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"

namespace {

using namespace std::chrono_literals;
using server::app::Catalogue;
using server::app::InsertAt;
using server::app::MoveTo;
using server::app::Tin;
using server::app::Version;
using server::app::VertexId;
using server::app::WorldEdit;
using tests::app::FailingStore;
using tin::base::Code;
using tin::base::Result;
using tin::terrain::Duplicates;
using tin::terrain::Remove;
using tin::terrain::SetZ;
using tin::terrain::Terrain;

Terrain grid_terrain(int side) {
  std::vector<tin::terrain::Placement> placements;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) placements.push_back({{x * 1000, y * 1000}, double(x + y)});
  }
  return *Terrain::build({}, placements, Duplicates::kReject);
}

class TinTest : public testing::Test {
 protected:
  FailingStore store_;
  Tin tin_{{{"t", "T", 5}, grid_terrain(20), Duplicates::kReject, std::nullopt, 1}, store_, 500};
  const server::store::RevisionInfo info_{};

  std::string digest() const {
    return tin_.read([](const Terrain& t, std::uint64_t) { return t.digest(); });
  }
  std::string broken() const {
    return tin_.read(
        [](const Terrain& t, std::uint64_t) { return tin::mesh::validate(t.mesh()).value_or(""); });
  }
};

TEST_F(TinTest, EditsAdvanceTheRevisionAndAreJournaled) {
  const std::vector<WorldEdit> edits{InsertAt{0.5, 0.5, 9}, SetZ{VertexId(1), 4}};
  const auto edited = tin_.edit(edits, {{}, info_});
  ASSERT_TRUE(edited.ok());
  EXPECT_EQ(edited->revision, 2U);
  EXPECT_EQ(edited->ids, (std::vector<VertexId>{VertexId(401), VertexId(1)}));
  EXPECT_EQ(store_.appended, 1U);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AnEditThatCannotBeStoredIsNeverSeen) {
  const std::string before = digest();
  store_.fail = true;
  const std::vector<WorldEdit> edits{InsertAt{0.5, 0.5, 9}, Remove{VertexId(7)},
                                     MoveTo{VertexId(9), 3.3, 3.3}};
  const auto edited = tin_.edit(edits, {{}, info_});
  ASSERT_FALSE(edited.ok());
  EXPECT_EQ(edited.error().code, Code::kStorage);
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(tin_.summary().revision, 1U);
  EXPECT_EQ(broken(), "");
  store_.fail = false;
  ASSERT_TRUE(tin_.edit(edits, {{}, info_}).ok());
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AnExpectedRevisionThatIsGoneIsRefused) {
  const std::vector<WorldEdit> edit{SetZ{VertexId(1), 4}};
  const std::array<std::uint64_t, 2> expected{1, 77};
  ASSERT_TRUE(tin_.edit(edit, {expected, info_}).ok());
  const auto late = tin_.edit(edit, {expected, info_});
  ASSERT_FALSE(late.ok());
  EXPECT_EQ(late.error().code, Code::kPrecondition);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AKeyHasOneEffectAndOneAnswer) {
  const std::vector<WorldEdit> edits{InsertAt{0.5, 0.5, 9}, SetZ{VertexId(7), 1}};
  const server::app::Terms terms{{}, info_, server::app::RequestKey{"key", "request"}};
  const auto first = tin_.edit(edits, terms);
  ASSERT_TRUE(first.ok());
  const std::string after = digest();
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(7), 2}}, {{}, info_}).ok());
  for (int i = 0; i < 3; ++i) {
    const auto again = tin_.edit(edits, terms);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(*again, *first);
  }
  EXPECT_EQ(tin_.revision(), 3U);
  const auto other = tin_.edit(edits, {{}, info_, server::app::RequestKey{"key", "another request"}});
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.error().code, Code::kInvalidValue);
  EXPECT_EQ(other.error().where, "header:Idempotency-Key");
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, ManyAtOnceWithOneKeyHaveOneEffect) {
  const std::vector<WorldEdit> edits{InsertAt{0.5, 0.5, 9}};
  const server::app::Terms terms{{}, info_, server::app::RequestKey{"key", "request"}};
  std::vector<std::thread> threads;
  for (int t = 0; t < 16; ++t) {
    threads.emplace_back([&] {
      const auto edited = tin_.edit(edits, terms);
      ASSERT_TRUE(edited.ok());
      EXPECT_EQ(edited->revision, 2U);
      EXPECT_EQ(edited->ids, (std::vector<VertexId>{VertexId(401)}));
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(tin_.revision(), 2U);
  EXPECT_EQ(store_.appended, 1U);
}

TEST_F(TinTest, ManyEditorsShareCommitsAndEachGetsItsOwnRevision) {
  store_.delay = 2ms;
  constexpr int kThreads = 16, kEdits = 10;
  std::vector<std::thread> threads;
  std::mutex mutex;
  std::set<std::uint64_t> revisions;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kEdits; ++i) {
        const std::vector<WorldEdit> edit{SetZ{VertexId(1 + 20 * t + i), 100.0 + i}};
        const auto edited = tin_.edit(edit, {{}, info_});
        ASSERT_TRUE(edited.ok());
        const std::lock_guard lock(mutex);
        EXPECT_TRUE(revisions.insert(edited->revision).second);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(revisions.size(), kThreads * kEdits);
  EXPECT_EQ(*revisions.rbegin(), 1U + kThreads * kEdits);
  EXPECT_LT(store_.commits, kThreads * kEdits / 2);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, WhatIsNotDurableYetIsSeenByNobody) {
  store_.delay = 1000ms;
  std::thread editor([&] {
    EXPECT_TRUE(tin_.edit(std::vector<WorldEdit>{InsertAt{0.5, 0.5, 9}}, {{}, info_}).ok());
  });
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(tin_.summary().vertex_count, 400U);
  EXPECT_EQ(tin_.version().terrain->vertex_count(), 400U);
  EXPECT_EQ(store_.commits, 0U) << "readers wait for no disk";
  editor.join();
  EXPECT_EQ(tin_.summary().vertex_count, 401U);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, UndoIsExactAndCanBeUndone) {
  const std::string before = digest();
  const std::vector<WorldEdit> edits{InsertAt{0.5, 0.5, 9}, Remove{VertexId(45)},
                                     MoveTo{VertexId(9), 3.3, 3.3}, SetZ{VertexId(3), 8}};
  ASSERT_TRUE(tin_.edit(edits, {{}, info_}).ok());
  const std::string edited = digest();
  ASSERT_TRUE(tin_.revert(2, {{}, info_}).ok());
  EXPECT_EQ(digest(), before);
  ASSERT_TRUE(tin_.revert(3, {{}, info_}).ok());
  EXPECT_EQ(digest(), edited);
  EXPECT_EQ(tin_.revision(), 4U);
  EXPECT_TRUE(tin_.read([](const Terrain& t, std::uint64_t) { return t.vertex(VertexId(401)).has_value(); }))
      << "it came back under its id";
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AnUndoThatLaterRevisionsStandAgainstSaysWhich) {
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(3), 8}}, {{}, info_}).ok());
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(5), 8}}, {{}, info_}).ok());
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(3), 9}}, {{}, info_}).ok());
  const std::string before = digest();
  const auto refused = tin_.revert(2, {{}, info_});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kConflict);
  EXPECT_NE(refused.error().message.find("vertex 3 was changed again by revision 4"), std::string::npos)
      << refused.error().message;
  EXPECT_EQ(digest(), before);
  EXPECT_TRUE(tin_.revert(3, {{}, info_}).ok()) << "nobody touched what that one changed";
  EXPECT_EQ(tin_.revert(1, {{}, info_}).error().code, Code::kGone);
  EXPECT_EQ(tin_.revert(77, {{}, info_}).error().code, Code::kNotFound);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, APlaceThatIsTakenMeanwhileStandsAgainstAnUndo) {
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{Remove{VertexId(1)}}, {{}, info_}).ok());
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{InsertAt{0, 0, 5}}, {{}, info_}).ok());
  const auto refused = tin_.revert(2, {{}, info_});
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("another vertex stands where vertex 1"), std::string::npos)
      << refused.error().message;
  EXPECT_EQ(broken(), "");
}

TEST(LargeUndoTest, IsBuiltAsideAndJustAsExact) {
  FailingStore store;
  Tin tin({{"t", "T", 5}, grid_terrain(200), Duplicates::kReject, std::nullopt, 1}, store, 50'000);
  const auto digest = [&] { return tin.read([](const Terrain& t, std::uint64_t) { return t.digest(); }); };
  const std::string before = digest();
  std::vector<VertexId> many;
  for (std::uint64_t id = 100; id < 35'000; ++id) many.emplace_back(id);
  ASSERT_TRUE(tin.land(tin.version(), {many, {}, {}}, {}).ok());
  const std::string removed = digest();
  ASSERT_TRUE(tin.edit(std::vector<WorldEdit>{SetZ{VertexId(3), 8}}, {}).ok());
  ASSERT_TRUE(tin.revert(3, {}).ok());
  ASSERT_TRUE(tin.revert(2, {}).ok());
  EXPECT_EQ(digest(), before);
  ASSERT_TRUE(tin.revert(5, {}).ok());
  EXPECT_EQ(digest(), removed);
  ASSERT_TRUE(tin.edit(std::vector<WorldEdit>{InsertAt{99, 0, 8}}, {}).ok());
  EXPECT_EQ(tin.revert(6, {}).error().code, Code::kConflict) << "vertex 100 stood there";
  EXPECT_EQ(
      tin.read([](const Terrain& t, std::uint64_t) { return tin::mesh::validate(t.mesh()).value_or(""); }),
      "");
}

TEST_F(TinTest, OneVertexPastTheLimitIsRefused) {
  std::vector<WorldEdit> edits;
  for (int i = 0; i < 100; ++i) edits.push_back(InsertAt{0.001 * (i + 1), 0.5, 1});
  ASSERT_TRUE(tin_.edit(edits, {{}, info_}).ok()) << "500 are allowed";
  const auto more = tin_.edit(std::vector<WorldEdit>{InsertAt{0.7, 0.7, 1}}, {{}, info_});
  ASSERT_FALSE(more.ok());
  EXPECT_EQ(more.error().code, Code::kTooLarge);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AVersionStaysWhatItWasWhileEditsGoOn) {
  const Version version = tin_.version();
  const std::string before = version.terrain->digest();
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{InsertAt{0.5 + i, 0.5, 1}}, {{}, info_}).ok());
  }
  EXPECT_EQ(version.terrain->digest(), before);
  EXPECT_EQ(version.revision, 1U);
  EXPECT_EQ(tin::mesh::validate(version.terrain->mesh()), std::nullopt);
  EXPECT_NE(digest(), before);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, PagesGoOnFromAKeptRevisionOnly) {
  tin_.keep_for_pages(tin_.version());
  tin_.drop_expired();
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(1), 4}}, {{}, info_}).ok());
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(1), 5}}, {{}, info_}).ok());
  EXPECT_EQ(tin_.page_version(1)->revision, 1U);
  EXPECT_EQ(tin_.page_version(3)->revision, 3U);
  ASSERT_FALSE(tin_.page_version(2).ok());
  EXPECT_EQ(tin_.page_version(2).error().code, Code::kGone);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, RemovalsOfAJobLeaveWhatWasEditedMeanwhile) {
  const Version seen = tin_.version();
  ASSERT_TRUE(
      tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(22), 99}, Remove{VertexId(23)}}, {{}, info_}).ok());
  std::vector<VertexId> ids;
  for (std::uint64_t id = 22; id < 340; ++id) ids.emplace_back(id);
  const auto landed = tin_.land(seen, {ids, {}, {}}, info_);
  ASSERT_TRUE(landed.ok());
  EXPECT_TRUE(landed->edited_meanwhile);
  EXPECT_EQ(landed->vertices_left, 400 - 1 - (ids.size() - 2));
  EXPECT_TRUE(tin_.read([](const Terrain& t, std::uint64_t) { return t.vertex(VertexId(22)).has_value(); }));
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, RemovalsBuiltAsideEqualRemovalsInPlace) {
  FailingStore other_store;
  Tin in_place({{"u", "U", 5}, grid_terrain(20), Duplicates::kReject, std::nullopt, 1}, other_store, 500);
  std::vector<VertexId> many;
  std::vector<WorldEdit> edits;
  for (std::uint64_t id = 50; id < 300; ++id) {
    many.emplace_back(id);
    edits.push_back(Remove{VertexId(id)});
  }
  ASSERT_TRUE(tin_.land(tin_.version(), {many, {}, {}}, info_).ok());
  ASSERT_TRUE(in_place.edit(edits, {{}, info_}).ok());
  EXPECT_EQ(digest(), in_place.read([](const Terrain& t, std::uint64_t) { return t.digest(); }));
  EXPECT_EQ(tin_.summary().triangle_count, in_place.summary().triangle_count);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AThinningPutsSamplesBackAndGivesHeights) {
  const Version seen = tin_.version();
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{InsertAt{0.5, 0.5, 9}, SetZ{VertexId(30), 5}}, {{}, info_}).ok());
  server::app::Thinning thinning;
  thinning.removed = {VertexId(22)};
  thinning.inserted = {{{500, 500}, 1}, {{1500, 1500}, 7}};  // at the first an edit stands by now
  thinning.reset = {{VertexId(30), seen.terrain->vertex(VertexId(30))->at, 2.5},
                    {VertexId(31), seen.terrain->vertex(VertexId(31))->at, 3.5}};
  const auto landed = tin_.land(seen, thinning, info_);
  ASSERT_TRUE(landed.ok());
  EXPECT_EQ(landed->vertices_left, 401U);
  EXPECT_TRUE(landed->edited_meanwhile);
  const Version now = tin_.version();
  EXPECT_FALSE(now.terrain->vertex(VertexId(22)));
  EXPECT_EQ(now.terrain->vertex(VertexId(401))->z, 9) << "edits stand";
  EXPECT_EQ(now.terrain->vertex(VertexId(402))->z, 7);
  EXPECT_EQ(now.terrain->vertex(VertexId(30))->z, 5) << "edits stand";
  EXPECT_EQ(now.terrain->vertex(VertexId(31))->z, 3.5);
  EXPECT_EQ(broken(), "");
}

TEST_F(TinTest, AThinningBuiltAsideEqualsOneInPlaceSamplesAndAll) {
  constexpr int kSide = 160;  // more vertices go than are removed one by one
  FailingStore other_store;
  Tin large({{"u", "U", 5}, grid_terrain(kSide), Duplicates::kReject, std::nullopt, 1}, other_store, 50000);
  const Version seen = large.version();
  server::app::Thinning thinning;
  for (std::uint64_t id = 200; id < 25000; ++id) thinning.removed.emplace_back(id);
  thinning.inserted = {{{1500, 7500}, 7}};
  thinning.reset = {{VertexId(9), seen.terrain->vertex(VertexId(9))->at, 2.5}};
  const Terrain aside = thinned(*seen.terrain, thinning);
  ASSERT_TRUE(large.land(seen, thinning, info_).ok());
  large.read([&](const Terrain& terrain, std::uint64_t) {
    EXPECT_EQ(terrain.digest(), aside.digest());
    EXPECT_EQ(terrain.next_id(), aside.next_id());
    EXPECT_EQ(terrain.amendments(), aside.amendments());
    EXPECT_EQ(terrain.amendments().own_in_force(terrain).size(), 24801U) << "without a source, what goes stays a sample";
    EXPECT_EQ(tin::mesh::validate(terrain.mesh()), std::nullopt);
  });
}

TEST_F(TinTest, AThinningThatBringsTooManyVerticesIsRefused) {
  server::app::Thinning thinning;
  for (int i = 0; i < 100; ++i) thinning.inserted.push_back({{500 + i, 500}, 1});
  EXPECT_EQ(tin_.land(tin_.version(), thinning, info_)->vertices_left, 500U);
  thinning.inserted = {{{700, 500}, 1}};
  const auto refused = tin_.land(tin_.version(), thinning, info_);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kTooLarge);
  EXPECT_EQ(tin_.summary().revision, 2U);
  EXPECT_EQ(broken(), "");
}

TEST(KeptVersionsTest, LastFiveMinutesTwoAtATime) {
  const auto terrain = std::make_shared<const Terrain>(grid_terrain(2));
  const auto now = server::app::KeptVersions::Clock::now();
  server::app::KeptVersions kept;
  kept.keep({terrain, 1}, now);
  kept.keep({terrain, 2}, now + 1min);
  kept.keep({terrain, 1}, now + 2min);
  kept.keep({terrain, 3}, now + 3min);
  EXPECT_TRUE(kept.find(1, now + 4min).has_value());
  EXPECT_FALSE(kept.find(2, now + 4min).has_value()) << "asked for the longest ago";
  EXPECT_FALSE(kept.find(1, now + 8min).has_value());
  EXPECT_TRUE(kept.find(3, now + 8min).has_value());
  EXPECT_EQ(terrain.use_count(), 3);
  kept.drop_expired(now + 9min);
  EXPECT_EQ(terrain.use_count(), 1);
}

TEST(OpenFrameTest, IsFittedToTheFirstVerticesAndFixedThen) {
  FailingStore store;
  Tin tin({{"t", "T", 5}, Terrain{tin::frame::Frame{}}, Duplicates::kReject, std::array<double, 2>{0, 0}, 1},
          store, 500);
  const std::vector<WorldEdit> far{InsertAt{5e6, 7e6, 1}, InsertAt{5e6 + 10, 7e6, 2},
                                   InsertAt{5e6, 7e6 + 10, 3}};
  ASSERT_TRUE(tin.edit(far, {}).ok());
  EXPECT_EQ(tin.summary().triangle_count, 1U);
  const auto near = tin.edit(std::vector<WorldEdit>{InsertAt{0, 0, 1}}, {});
  ASSERT_FALSE(near.ok());
  EXPECT_EQ(near.error().code, Code::kOutsideLattice);
  EXPECT_EQ(near.error().where, "/0");
}

TEST(ConcurrencyTest, ReadersAnEditorAndALongReaderTogether) {
  FailingStore store;
  Tin tin({{"t", "T", 5}, grid_terrain(30), Duplicates::kReplace, std::nullopt, 1}, store, 5000);
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  for (int reader = 0; reader < 2; ++reader) {
    threads.emplace_back([&] {
      std::uint64_t last = 0;
      while (!stop) {
        tin.read([&](const Terrain& terrain, std::uint64_t revision) {
          EXPECT_GE(revision, last);
          last = revision;
          tin::query::ElevationQuery query(terrain, tin::query::Voids::kKeep);
          EXPECT_TRUE(query.at({1500, 1500}).has_value());
        });
        tin.summary();
      }
    });
  }
  threads.emplace_back([&] {
    while (!stop) {
      const Version version = tin.version();
      const std::string digest = version.terrain->digest();
      EXPECT_EQ(tin::mesh::validate(version.terrain->mesh()), std::nullopt);
      EXPECT_EQ(version.terrain->digest(), digest);
      tin.keep_for_pages(version);
    }
  });
  for (int i = 0; i < 300; ++i) {
    const double x = 0.001 * (i % 97) + 0.3;
    ASSERT_TRUE(
        tin.edit(std::vector<WorldEdit>{InsertAt{x, 0.77, double(i)}, SetZ{VertexId(3), double(i)}}, {})
            .ok());
  }
  stop = true;
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(tin.summary().revision, 301U);
}

TEST(TinMemoryTest, ASourceCountsWhileSomebodyHasItInHand) {
  FailingStore store;
  Terrain terrain = grid_terrain(20);
  const auto samples = server::app::vertices_as_source(terrain);
  const auto give = server::app::attach_source(terrain, samples, server::app::Completeness::kAllSamples);
  ASSERT_TRUE(give([&store](std::string_view piece) -> tin::base::Result<void> {
    store.source += piece;
    return {};
  }));
  const Tin tin({{"t", "T", 5}, std::move(terrain), Duplicates::kReject, std::nullopt, 1}, store, 500);
  const std::uint64_t alone = tin.held_bytes();
  {
    const auto source = tin.source(server::app::ScratchSpace({})).value();
    const std::uint64_t bytes = server::app::estimated_bytes(*source);
    EXPECT_GE(bytes, 400 * sizeof(tin::exact::Point));
    EXPECT_EQ(tin.held_bytes(), alone + bytes);
  }
  EXPECT_EQ(tin.held_bytes(), alone);
}

TEST_F(TinTest, AnEditsAnswerIsFoundByItsKeyAndItsVertexAsItWasThen) {
  const server::app::RequestKey key{"k", "request"};
  ASSERT_EQ(tin_.answered(key).value(), std::nullopt);
  const std::vector<WorldEdit> insert{InsertAt{0.5, 0.5, 9}};
  const auto made = tin_.edit(insert, {{}, info_, key});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(tin_.answered(key).value(), made.value());
  EXPECT_EQ(tin_.answered({"k", "other"}).error().code, Code::kInvalidValue);
  EXPECT_EQ(tin_.vertex_after(2, VertexId(401))->z, 9);
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{SetZ{VertexId(401), 4}}, {{}, info_}).ok());
  ASSERT_TRUE(tin_.edit(std::vector<WorldEdit>{Remove{VertexId(401)}}, {{}, info_}).ok());
  EXPECT_EQ(tin_.vertex_after(2, VertexId(401))->z, 9);
  EXPECT_EQ(tin_.vertex_after(3, VertexId(401))->z, 4);
  EXPECT_FALSE(tin_.vertex_after(4, VertexId(401)).has_value());
  EXPECT_FALSE(tin_.vertex_after(3, VertexId(1)).has_value()) << "that revision did not touch it";
}

}  // namespace
