#include "tests/bench/arguments.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace bench {
namespace {

std::size_t parse(const std::string& text) {
  std::size_t value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) throw std::runtime_error("not a number: " + text);
  return value;
}

}  // namespace

Arguments::Arguments(std::span<const std::string> arguments, std::span<const std::string_view> known) {
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    if (std::find(known.begin(), known.end(), arguments[i]) == known.end()) {
      throw std::runtime_error("unknown option " + arguments[i]);
    }
    if (i + 1 == arguments.size()) throw std::runtime_error(arguments[i] + " needs a value");
    values_[arguments[i]] = arguments[i + 1];
  }
}

std::string Arguments::text(const std::string& name, const std::string& otherwise) const {
  const auto found = values_.find(name);
  return found == values_.end() ? otherwise : found->second;
}

std::size_t Arguments::number(const std::string& name, std::size_t otherwise) const {
  const auto found = values_.find(name);
  return found == values_.end() ? otherwise : parse(found->second);
}

std::vector<std::size_t> Arguments::numbers(const std::string& name, const std::string& otherwise) const {
  std::vector<std::size_t> out;
  for (const auto& part : list(name, otherwise)) out.push_back(parse(part));
  return out;
}

std::vector<std::string> Arguments::list(const std::string& name, const std::string& otherwise) const {
  const std::string all = text(name, otherwise);
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= all.size();) {
    const std::size_t comma = std::min(all.find(',', from), all.size());
    if (comma > from) parts.push_back(all.substr(from, comma - from));
    from = comma + 1;
  }
  return parts;
}

}  // namespace bench
