#include "tin/removal/method.h"

#include <utility>

#include "tin/removal/edge_completion.h"
#include "tin/removal/mixed.h"
#include "tin/removal/production.h"

namespace tin::removal {
namespace {

constexpr std::uint32_t kFirstLimit = 5, kLastLimit = 11;  // of mixed

template <class Algorithm>
class Named final : public Method {
 public:
  Named(std::string name, Algorithm algorithm) : name_(std::move(name)), algorithm_(std::move(algorithm)) {}
  std::string_view name() const override { return name_; }
  std::span<const Ear> fill(const Star& star) override {
    NoCounters none;
    return algorithm_.fill(star, none);
  }
  std::span<const Ear> fill(const Star& star, Counters& counters) override {
    return algorithm_.fill(star, counters);
  }

 private:
  std::string name_;
  Algorithm algorithm_;
};

template <class Algorithm>
std::unique_ptr<Method> named(std::string_view name, Algorithm algorithm) {
  return std::make_unique<Named<Algorithm>>(std::string(name), std::move(algorithm));
}

std::string mixed_name(std::uint32_t limit) { return "mixed:" + std::to_string(limit); }

}  // namespace

std::unique_ptr<Method> make_method(std::string_view name) {
  if (name == "ear3") return named(name, Ear3());
  if (name == "ear3-update") return named(name, Ear3(Renewal::kUpdate));
  if (name == "ear5") return named(name, Ear5());
  if (name == "flip") return named(name, Flip());
  if (name == "edge-completion") return named(name, EdgeCompletion());
  if (name == "chew") return named(name, Chew());
  if (name == "production") return named(name, Production());
  for (std::uint32_t limit = kFirstLimit; limit <= kLastLimit; ++limit) {
    if (name == mixed_name(limit)) return named(name, Mixed(limit));
  }
  return nullptr;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names{"ear3", "ear3-update", "ear5", "flip"};
  for (std::uint32_t limit = kFirstLimit; limit <= kLastLimit; ++limit) names.push_back(mixed_name(limit));
  for (const char* name : {"edge-completion", "chew", "production"}) names.emplace_back(name);
  return names;
}

}  // namespace tin::removal
