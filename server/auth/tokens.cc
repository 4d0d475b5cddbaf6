#include "server/auth/tokens.h"

#include <sodium.h>

#include <algorithm>
#include <array>

#include "tin/base/check.h"

namespace server::auth {
namespace {

constexpr std::string_view kTokenPrefix =
    "tinsmith_";  // so that a leaked one is found by those who look for such
constexpr std::string_view kHashPrefix = "sha256:";
constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kHashDigits = 2 * crypto_hash_sha256_BYTES;

void prepare() {
  static const int ready = sodium_init();
  TIN_CHECK(ready >= 0);
}

bool is_hex_digit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

}  // namespace

std::string make_token() {
  prepare();
  std::array<unsigned char, kTokenBytes> bytes{};
  randombytes_buf(bytes.data(), bytes.size());
  constexpr int kVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
  std::array<char, sodium_base64_ENCODED_LEN(kTokenBytes, kVariant)> text{};
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), kVariant);
  return std::string(kTokenPrefix) + text.data();
}

std::string hash_token(std::string_view token) {
  prepare();
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(token.data()), token.size());
  std::array<char, kHashDigits + 1> text{};
  sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
  return std::string(kHashPrefix) + text.data();
}

bool is_hash(std::string_view text) {
  if (!text.starts_with(kHashPrefix)) return false;
  text.remove_prefix(kHashPrefix.size());
  return text.size() == kHashDigits && std::all_of(text.begin(), text.end(), is_hex_digit);
}

std::optional<std::string_view> bearer_token(std::string_view authorization) {
  constexpr std::string_view kScheme = "bearer ";
  if (authorization.size() <= kScheme.size()) return std::nullopt;
  for (std::size_t i = 0; i < kScheme.size(); ++i) {
    const char c = authorization[i];
    if ((c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) != kScheme[i]) return std::nullopt;
  }
  authorization.remove_prefix(
      std::min(authorization.find_first_not_of(' ', kScheme.size()), authorization.size()));
  if (authorization.empty() || authorization.find(' ') != std::string_view::npos) return std::nullopt;
  return authorization;
}

Tokens::Tokens(std::vector<Grant> grants) : grants_(std::move(grants)) {
  for (const Grant& grant : grants_) TIN_CHECK(is_hash(grant.hash));
}

const Grant* Tokens::find(std::string_view token) const {
  const std::string hash = hash_token(token);
  const Grant* found = nullptr;
  for (const Grant& grant : grants_) {
    if (sodium_memcmp(hash.data(), grant.hash.data(), hash.size()) == 0) found = &grant;
  }
  return found;
}

}  // namespace server::auth
