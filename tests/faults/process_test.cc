// The program itself is killed and stopped while clients edit: nothing acknowledged is lost, nothing is torn,
// each key has one effect, and a backup taken meanwhile is whole.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <atomic>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "server/app/tin.h"
#include "server/store/sqlite_store.h"
#include "tests/e2e/served.h"
#include "tests/faults/scenario.h"
#include "tin/codec/change.h"
#include "tin/codec/checkpoint.h"
#include "tin/mesh/validate.h"
#include "tin/terrain/vertex_set.h"

namespace tests::faults {
namespace {

using e2e::Json;
using e2e::Served;
using e2e::ServedTest;

constexpr int kSide = 20;
constexpr int kClients = 4;

/// What one client sent last and has no answer to, and what it knows to be done.
struct Client {
  std::map<int, double> heights;  // of its vertices, as acknowledged
  std::uint64_t inserted = 0;
  std::uint64_t last_revision = 1;
  std::uint64_t sent = 0;
  std::string pending_body, pending_key;  // "" when all is answered
  int pending_id = 0;                     // 0: an insertion
  double pending_z = 0;
};

class ProcessTest : public ServedTest {
 protected:
  void SetUp() override {
    start();
    Json vertices = Json::array();
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) vertices.push_back({x, y, x + y});
    }
    ASSERT_EQ(served_->http().post_json("/tins", Json{{"id", "t"}, {"vertices", vertices}}.dump()).status,
              201);
  }

  static void prepare(Client& client, int number) {
    ++client.sent;
    client.pending_key = std::to_string(number) + "-" + std::to_string(client.sent);
    const double z = 1000.0 * number + static_cast<double>(client.sent);
    if (client.sent % 5 == 0) {
      client.pending_id = 0;
      const double x = 0.5 + number * 4 + 0.0002 * static_cast<double>(client.sent);
      client.pending_body = Json{{"ops", {{{"op", "insert"}, {"x", x}, {"y", 0.3}, {"z", z}}}}}.dump();
    } else {
      client.pending_id = 1 + number + kClients * static_cast<int>(client.sent % 90);
      client.pending_z = z;
      client.pending_body = Json{{"ops", {{{"op", "set-z"}, {"id", client.pending_id}, {"z", z}}}}}.dump();
    }
  }

  /// Sends what is pending; whether it was acknowledged.
  static bool send(const support::HttpClient& http, Client& client) {
    support::RawAnswer answer;
    try {
      answer = http.post_json("/tins/t/edits", client.pending_body,
                              "Idempotency-Key: " + client.pending_key + "\r\n");
    } catch (const std::exception&) {
      return false;  // nobody listens any more
    }
    if (answer.status != 200 || !answer.complete) return false;
    const std::uint64_t revision = Json::parse(answer.body).at("revision");
    EXPECT_GT(revision, client.last_revision);
    client.last_revision = revision;
    if (client.pending_id == 0) ++client.inserted;
    if (client.pending_id != 0) client.heights[client.pending_id] = client.pending_z;
    client.pending_body.clear();
    return true;
  }

  /// Clients edit until the server is gone; `end` ends it after `life`.
  template <class End>
  void edit_until(std::chrono::microseconds life, End end) {
    std::vector<std::thread> threads;
    for (int c = 0; c < kClients; ++c) {
      threads.emplace_back([&, c, http = served_->http()] {
        Client& client = clients_[c];
        do {
          if (client.pending_body.empty()) prepare(client, c);
        } while (send(http, client));
      });
    }
    std::this_thread::sleep_for(life);
    end();
    for (std::thread& thread : threads) thread.join();
  }

  /// The folder without its server: sound, and all that was acknowledged is there.
  void expect_whole() {
    const auto store = server::store::open_sqlite_store(data());
    ASSERT_TRUE(store.ok()) << store.error().message;
    const auto state = server::app::Tin::load(**store, "t");
    ASSERT_TRUE(state.ok()) << state.error().message;
    EXPECT_EQ(tin::mesh::validate(state->terrain.mesh()), std::nullopt);
    digest_ = state->terrain.digest();
    EXPECT_EQ(digest_, replayed_digest(**store));
    std::uint64_t pending_insertions = 0, inserted = 0;
    for (const Client& client : clients_) {
      EXPECT_GE(state->revision, client.last_revision);
      inserted += client.inserted;
      pending_insertions += !client.pending_body.empty() && client.pending_id == 0 ? 1 : 0;
      for (const auto& [id, z] : client.heights) {
        const double found = state->terrain.vertex(server::app::VertexId(static_cast<std::uint64_t>(id)))->z;
        const bool pending =
            !client.pending_body.empty() && client.pending_id == id && found == client.pending_z;
        EXPECT_TRUE(found == z || pending) << "vertex " << id << ": " << found << " instead of " << z;
      }
    }
    const std::size_t extra = state->terrain.vertex_count() - kSide * kSide;
    EXPECT_GE(extra, inserted);
    EXPECT_LE(extra, inserted + pending_insertions);
  }

  /// The digest of what checkpoint and journal say, without a mesh.
  static std::string replayed_digest(server::store::Store& store) {
    const auto loaded = store.load("t");
    const auto checkpoint = tin::codec::decode_checkpoint(loaded.value().checkpoint);
    tin::terrain::VertexSet set(checkpoint->vertices, checkpoint->next_id);
    for (const auto& row : loaded->journal)
      EXPECT_TRUE(set.replay(*tin::codec::decode_change(row.record)).ok());
    return tin::terrain::digest_of(set.vertices(), checkpoint->frame);
  }

  /// What had no answer is sent again with its key: now it has one effect, whether it had one before or not.
  void send_again() {
    for (Client& client : clients_) {
      if (client.pending_body.empty()) continue;
      EXPECT_TRUE(send(served_->http(), client));
    }
    std::uint64_t inserted = 0;
    for (const Client& client : clients_) inserted += client.inserted;
    EXPECT_EQ(served_->get("/tins/t").at("vertexCount"), kSide * kSide + inserted);
  }

  Client clients_[kClients];
  std::string digest_;
};

TEST_F(ProcessTest, KilledAtAnyMomentItLosesNothingAcknowledged) {
  std::mt19937_64 random(chosen_seed());
  for (int round = 0; round < rounds("TINSMITH_KILLS", 50) && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    edit_until(std::chrono::microseconds(random() % 60'000), [&] { served_->kill(); });
    expect_whole();
    start();
    EXPECT_EQ(served_->get("/tins/t").at("digest"), digest_);
    send_again();
  }
  std::uint64_t acknowledged = 0;
  for (const Client& client : clients_) acknowledged += client.sent;
  std::cout << acknowledged << " edits" << std::endl;
}

TEST_F(ProcessTest, StoppedUnderLoadItEndsInOrderAndLosesNothing) {
  for (int round = 0; round < rounds("TINSMITH_STOPS", 3) && !HasFailure(); ++round) {
    const auto begin = std::chrono::steady_clock::now();
    edit_until(std::chrono::milliseconds(100), [&] { EXPECT_EQ(served_->stop(), 0); });
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
    expect_whole();
    start();
    send_again();
  }
}

TEST_F(ProcessTest, OneKeyHasOneEffectHoweverOftenItIsSentAcrossCrashes) {
  const std::string body = R"({"ops":[{"op":"insert","x":0.5,"y":0.5,"z":7}]})";
  const int times = rounds("TINSMITH_KEY_REPEATS", 60);
  std::string first;
  for (int sent = 0; sent < times && !HasFailure(); ++sent) {
    const auto answer = served_->http().post_json("/tins/t/edits", body, "Idempotency-Key: once\r\n");
    ASSERT_EQ(answer.status, 200) << answer.body;
    if (first.empty()) first = answer.body;
    EXPECT_EQ(answer.body, first);
    if (sent % 20 == 10) {
      served_->kill();
      start();
    }
  }
  EXPECT_EQ(served_->get("/tins/t").at("vertexCount"), kSide * kSide + 1);
  EXPECT_EQ(served_->get("/tins/t").at("revision"), 2);
}

TEST_F(ProcessTest, ABackupTakenUnderLoadIsWholeAndCanBeServed) {
  const std::string file = folder_.path() / "backup";
  edit_until(std::chrono::milliseconds(50), [&] {
    const auto taken = support::run({TINSMITH_PROGRAM, "backup", data().string(), file});
    EXPECT_EQ(taken.status, 0) << taken.err;
    const auto again = support::run({TINSMITH_PROGRAM, "backup", data().string(), file});
    EXPECT_EQ(again.status, 1) << "nothing is overwritten";
    served_->kill();
  });
  const std::string restored = folder_.path() / "restored";
  const auto back = support::run({TINSMITH_PROGRAM, "restore", file, restored});
  ASSERT_EQ(back.status, 0) << back.err;
  EXPECT_EQ(support::run({TINSMITH_PROGRAM, "restore", file, data().string()}).status, 1) << "not empty";
  const auto checked = support::run({TINSMITH_PROGRAM, "check", restored});
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  Served from_backup(restored);
  EXPECT_GT(from_backup.get("/tins/t").at("revision"), 1);
  EXPECT_EQ(from_backup.stop(), 0);
}

TEST_F(ProcessTest, JobsAreKnownAgainAfterARestart) {
  const auto done = served_->http().post_json("/processes/simplify/execution",
                                              R"({"inputs":{"tin":"t","tolerance":1,"as":"coarse"}})",
                                              "Prefer: respond-async\r\n");
  ASSERT_EQ(done.status, 201) << done.body;
  const std::string job = done.header("location");
  EXPECT_EQ(served_->finished_job(job).at("status"), "successful");
  const std::string results = served_->http().get(job + "/results").body;
  served_->kill();
  start();
  EXPECT_EQ(served_->get(job).at("status"), "successful");
  EXPECT_EQ(served_->http().get(job + "/results").body, results);
}

TEST_F(ProcessTest, CheckFindsWhatIsDamaged) {
  served_->edit("t", Json::array({{{"op", "set-z"}, {"id", 1}, {"z", 5}}}));
  const auto running = support::run({TINSMITH_PROGRAM, "check", data().string()});
  EXPECT_EQ(running.status, 0) << running.out << running.err;
  EXPECT_NE(running.out.find("t: sound, revision 2, 400 vertices"), std::string::npos) << running.out;
  EXPECT_EQ(served_->stop(), 0);
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open((data() / "tinsmith.sqlite3").c_str(), &raw), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(raw, "UPDATE journal SET note = 'spoilt'", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(raw);
  const auto checked = support::run({TINSMITH_PROGRAM, "check", data().string()});
  EXPECT_EQ(checked.status, 1);
  EXPECT_NE(checked.out.find("t: damaged"), std::string::npos) << checked.out;
  EXPECT_EQ(support::run({TINSMITH_PROGRAM, "check", folder_.path().string()}).status, 2) << "no store";
}

}  // namespace
}  // namespace tests::faults
