// Bearer tokens: who may read, who may write. The server keeps their hashes only.
//
//   const std::string token = make_token();             // for a client: "tinsmith_..."
//   Tokens tokens({{"survey", hash_token(token), true, true}});
//   const Grant* grant = tokens.find(token);             // nobody: nullptr
//   if (grant != nullptr && grant->write) ...
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace server::auth {

/// What the bearer of a token may do. `hash` is as hash_token() writes it.
struct Grant {
  std::string name;  // for the log
  std::string hash;
  bool read = true;
  bool write = false;
  friend bool operator==(const Grant&, const Grant&) = default;
};

/// A new token of 256 random bits, in letters, digits, '-' and '_'.
std::string make_token();

/// "sha256:" and 64 hexadecimal digits. A token has too many bits to be guessed, so a slow hash would protect
/// nobody and let anybody keep the server busy.
std::string hash_token(std::string_view token);

/// Whether `text` has the form of a hash.
bool is_hash(std::string_view text);

/// The token in an Authorization field, whose scheme is Bearer in any case of letters; nothing otherwise.
std::optional<std::string_view> bearer_token(std::string_view authorization);

/// Thread-safe.
class Tokens {
 public:
  explicit Tokens(std::vector<Grant> grants);

  bool empty() const { return grants_.empty(); }

  /// The grant of a token. Takes the same time whichever it is, and whether there is one.
  const Grant* find(std::string_view token) const;

 private:
  std::vector<Grant> grants_;
};

}  // namespace server::auth
