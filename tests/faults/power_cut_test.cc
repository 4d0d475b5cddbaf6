// The power fails at any moment: whatever was synced is there, of everything later each sector of 512 bytes
// is there or not. Nothing acknowledged is lost then, and nothing is torn.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>

#include "tests/faults/faulty_disk.h"
#include "tests/faults/scenario.h"
#include "tests/support/temp_dir.h"

namespace tests::faults {
namespace {

constexpr std::size_t kSector = 512;

/// What a disk may hold after a cut.
class CutDisk {
 public:
  explicit CutDisk(std::mt19937_64& random) : random_(random) {}

  void follow(const Event& event) {
    switch (event.kind) {
      case Event::kWrite:
      case Event::kTruncate:
        pending_[event.path].push_back(event);
        break;
      case Event::kSync:
        settle_names();  // a journaling file system brings earlier names along with a later sync
        settle(event.path);
        break;
      case Event::kSyncFolder:
        settle_names();
        break;
      case Event::kRemove:
      case Event::kRename:
        names_.push_back(event);
        break;
      case Event::kAcknowledged:
        break;
    }
  }

  /// The power fails now.
  void cut() {
    if (random_() % 2 == 0) settle_names();
    const std::uint64_t mode = random_() % 5;  // nothing arrives, everything does, or any part of it
    for (const auto& [path, events] : pending_) {
      for (const Event& event : events) {
        if (event.kind == Event::kTruncate) continue;
        for (std::size_t at = 0; at < event.bytes.size(); at += kSector) {
          const bool arrives = mode == 1 || (mode > 1 && random_() % 2 == 0);
          if (arrives) put(path, event.offset + at, std::string_view(event.bytes).substr(at, kSector));
        }
      }
    }
  }

  void save(const std::filesystem::path& from, const std::filesystem::path& to) const {
    std::filesystem::create_directory(to / "files");
    for (const auto& [path, bytes] : files_) {
      if (path.ends_with("-shm")) continue;
      std::ofstream out(to / std::filesystem::relative(path, from), std::ios::binary);
      out << bytes;
    }
  }

 private:
  void put(const std::string& path, std::size_t offset, std::string_view bytes) {
    std::string& file = files_[path];
    if (file.size() < offset + bytes.size()) file.resize(offset + bytes.size());
    file.replace(offset, bytes.size(), bytes);
  }
  void settle(const std::string& path) {
    for (const Event& event : pending_[path]) {
      if (event.kind == Event::kWrite) put(path, event.offset, event.bytes);
      if (event.kind == Event::kTruncate) files_[path].resize(event.offset);
    }
    pending_.erase(path);
  }
  void settle_names() {
    for (const Event& event : names_) {
      if (event.kind == Event::kRename) {
        files_[event.to] = std::move(files_[event.path]);
        if (const auto late = pending_.extract(event.path)) pending_[event.to] = late.mapped();
      }
      files_.erase(event.path);
      pending_.erase(event.path);
    }
    names_.clear();
  }

  std::mt19937_64& random_;
  std::map<std::string, std::string> files_;
  std::map<std::string, std::vector<Event>> pending_;
  std::vector<Event> names_;
};

TEST(PowerCutTest, NothingAcknowledgedIsLostAndNothingIsTorn) {
  std::mt19937_64 random(chosen_seed());
  const support::TempDir folder;
  std::map<std::uint64_t, std::string> digests;  // by revision
  std::vector<Event> events;
  {
    FaultyDisk disk;
    disk.start_recording();
    Scenario scenario(folder.path(), disk.options());
    const auto note = [&](std::uint64_t revision) {
      digests[scenario.revision()] = scenario.digest();
      disk.acknowledged(revision);
    };
    note(scenario.revision());
    for (int i = 0; i < 3; ++i) scenario.run(note);
    events = disk.recorded();
  }
  const auto begins = std::find_if(events.begin(), events.end(),
                                   [](const Event& event) { return event.kind == Event::kAcknowledged; });
  const auto first = static_cast<std::size_t>(begins - events.begin()) + 1;
  for (int round = 0; round < rounds("TINSMITH_POWER_CUTS", 100) && !HasFailure(); ++round) {
    const std::size_t cut = first + random() % (events.size() - first + 1);
    SCOPED_TRACE("cut after event " + std::to_string(cut) + " of " + std::to_string(events.size()));
    CutDisk disk(random);
    std::uint64_t acknowledged = 0;
    for (std::size_t i = 0; i < cut; ++i) {
      disk.follow(events[i]);
      if (events[i].kind == Event::kAcknowledged) acknowledged = std::max(acknowledged, events[i].offset);
    }
    disk.cut();
    const support::TempDir after;
    disk.save(folder.path(), after.path());
    EXPECT_EQ(broken_on_disk(after.path(), acknowledged, digests.at(acknowledged)), "");
  }
}

}  // namespace
}  // namespace tests::faults
