// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/sha256.h"

#include <openssl/evp.h>

#include <array>

#include "lucerna/core/io/error.h"

namespace lucerna {

std::string sha256_of_text(std::string_view text) {
  std::array<unsigned char, 32> digest{};
  unsigned size = 0;
  const int status = EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr);
  LUCERNA_CHECK(status == 1 && size == digest.size(), "SHA-256 is not available");
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

}  // namespace lucerna
