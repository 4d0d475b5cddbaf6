// Options of the form --name value.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bench {

class Arguments {
 public:
  /// Throws std::runtime_error unless each option is one of `known` and has a value.
  Arguments(std::span<const std::string> arguments, std::span<const std::string_view> known);

  std::string text(const std::string& name, const std::string& otherwise) const;
  /// These throw std::runtime_error for what is no number.
  std::size_t number(const std::string& name, std::size_t otherwise) const;
  std::vector<std::size_t> numbers(const std::string& name, const std::string& otherwise) const;
  /// The parts between commas.
  std::vector<std::string> list(const std::string& name, const std::string& otherwise) const;

 private:
  std::map<std::string, std::string> values_;
};

}  // namespace bench
