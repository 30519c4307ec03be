// mesh.upload: gives the session a mesh that its scene can name. The session's thread reads it and answers.
#include "server/base/base64.h"
#include "server/net/client.h"
#include "server/net/methods.h"

namespace clothlab::net {

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
