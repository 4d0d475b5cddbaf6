#include "server/app/write.h"

#include <charconv>

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

/// Takes a number and what follows it off `text`: "17;..." with ';'. False when it is not there.
bool take(std::string_view& text, char end, std::uint64_t& number) {
  const auto [rest, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  const auto length = static_cast<std::size_t>(rest - text.data());
  if (failure != std::errc() || length == text.size() || *rest != end) return false;
  text.remove_prefix(length + 1);
  return true;
}

}  // namespace

/// "revision;first+count,first+count," with runs of ids that ascend by one: a batch of new vertices is one
/// run. Where edits of areas are among them, "|index:count,index:count," follows.
std::string encode_edited(const Edited& edited) {
  std::string out = std::to_string(edited.revision) + ";";
  for (std::size_t i = 0; i < edited.ids.size();) {
    std::size_t end = i + 1;
    while (end < edited.ids.size() && edited.ids[end].value() == edited.ids[end - 1].value() + 1) ++end;
    out.append(std::to_string(edited.ids[i].value())).append(1, '+');
    out.append(std::to_string(end - i)).append(1, ',');
    i = end;
  }
  if (!edited.areas.empty()) out += '|';
  for (const auto& [index, count] : edited.areas)
    out.append(std::to_string(index)).append(1, ':').append(std::to_string(count)).append(1, ',');
  return out;
}

Result<Edited> decode_edited(std::string_view bytes) {
  const auto malformed = [] { return error(Code::kStorage, "An answer that was kept cannot be read."); };
  Edited edited;
  if (!take(bytes, ';', edited.revision)) return malformed();
  while (!bytes.empty() && bytes.front() != '|') {
    std::uint64_t first = 0, count = 0;
    if (!take(bytes, '+', first) || !take(bytes, ',', count)) return malformed();
    for (std::uint64_t i = 0; i < count; ++i) edited.ids.emplace_back(first + i);
  }
  if (!bytes.empty()) bytes.remove_prefix(1);
  while (!bytes.empty()) {
    std::uint64_t index = 0, count = 0;
    if (!take(bytes, ':', index) || !take(bytes, ',', count)) return malformed();
    edited.areas.emplace_back(index, count);
  }
  return edited;
}

}  // namespace server::app
