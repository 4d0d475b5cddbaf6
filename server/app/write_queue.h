// Whoever comes first carries out what waits: the writes of many clients become one batch, and one commit of
// the store, without a thread of their own.
//
//   WriteQueue<Write> queue([this](std::span<Write* const> batch) { carry_out(batch); });
//   queue.submit(write);  // returns when the write was carried out, by this thread or another one
#pragma once

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <span>

namespace server::app {

/// Thread-safe. Batches are carried out one at a time, in the order of their coming. Item has `weight` (its
/// cost) and `alone` (it shares no batch).
template <class Item>
class WriteQueue {
 public:
  /// Carries out a batch; must not throw.
  using CarryOut = std::function<void(std::span<Item* const>)>;

  explicit WriteQueue(CarryOut carry_out) : carry_out_(std::move(carry_out)) {}

  void submit(Item& item) {
    Waiting self{item};
    std::unique_lock lock(mutex_);
    waiting_.push_back(&self);
    if (leading_) self.changed.wait(lock, [&] { return self.done || self.leads; });
    if (self.done) return;
    leading_ = true;
    std::array<Waiting*, kMostInBatch> batch;
    std::array<Item*, kMostInBatch> items;
    const std::size_t size = take_batch(batch);
    for (std::size_t i = 0; i < size; ++i) items[i] = &batch[i]->item;
    lock.unlock();
    carry_out_({items.data(), size});
    lock.lock();
    for (std::size_t i = 0; i < size; ++i) {
      batch[i]->done = true;
      if (batch[i] != &self) batch[i]->changed.notify_one();
    }
    leading_ = !waiting_.empty();
    if (!leading_) return;
    waiting_.front()->leads = true;
    waiting_.front()->changed.notify_one();
  }

 private:
  struct Waiting {
    Item& item;
    bool done = false;
    bool leads = false;
    std::condition_variable changed = {};
  };
  static constexpr std::size_t kMostInBatch = 256;
  // Small writes wait for no more than so much besides their own.
  static constexpr std::size_t kHeaviestBatch = 20'000;

  /// The front, which is the caller, and what may come with it. Requires: mutex_.
  std::size_t take_batch(std::array<Waiting*, kMostInBatch>& batch) {
    std::size_t size = 0, weight = 0;
    while (!waiting_.empty() && size < kMostInBatch) {
      Waiting* next = waiting_.front();
      if (size > 0 && (next->item.alone || weight + next->item.weight > kHeaviestBatch)) break;
      weight += next->item.weight;
      batch[size++] = next;
      waiting_.pop_front();
      if (next->item.alone) break;
    }
    return size;
  }

  const CarryOut carry_out_;
  std::mutex mutex_;
  std::deque<Waiting*> waiting_;
  bool leading_ = false;
};

}  // namespace server::app
