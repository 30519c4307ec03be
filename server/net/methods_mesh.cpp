// mesh.upload: gives the session a mesh that its scene can name. The session's thread reads it and answers.
#include "server/net/client.h"
#include "server/net/methods.h"

namespace clothlab::net {

namespace {

/// The bytes of a text in base64 (RFC 4648, padded), or nothing if it is none.
std::optional<std::string> from_base64(const std::string& text) {
  if (text.size() % 4 != 0) return std::nullopt;
  const auto value = [](char c) -> int {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  };
  std::size_t length = text.size();
  while (length > 0 && text[length - 1] == '=' && text.size() - length < 2) --length;
  std::string bytes;
  bytes.reserve(length / 4 * 3 + 2);
  unsigned bits = 0, count = 0;
  for (std::size_t i = 0; i < length; ++i) {
    const int digit = value(text[i]);
    if (digit < 0) return std::nullopt;
    bits = (bits << 6 | static_cast<unsigned>(digit)) & 0xffffff;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xff));
  }
  return bytes;
}

}  // namespace

Outcome mesh_upload(Client& client, const Request& request) {
  Params params(request.params);
  session::UploadMesh upload;
  upload.name = params.label("name", session::max_mesh_name_bytes, std::nullopt);
  upload.bytes = params.text("obj", std::nullopt);
  const std::string encoding = params.text("encoding", "text");
  if (encoding != "text" && encoding != "base64") params.refuse("encoding", "text or base64");
  if (auto error = params.check()) return *error;
  if (encoding == "base64") {
    std::optional<std::string> bytes = from_base64(upload.bytes);
    if (!bytes) return invalid_params("/obj", "text that is not base64", "base64 (RFC 4648), padded");
    upload.bytes = std::move(*bytes);
  }
  upload.in_hand = client.begin_upload();
  if (!upload.in_hand)
    return RpcError{error_over_limit, "a mesh of yours is being read; wait for its answer", nullptr};
  return ask_session(client, request, std::move(upload));
}

}  // namespace clothlab::net
