// mesh.upload: gives the session a mesh that its scene can name. The session's thread reads it and answers.
#include "server/net/client.h"
#include "server/net/methods.h"

namespace clothlab::net {

Outcome mesh_upload(Client& client, Request& request) {
  Params params(request.params);
  session::UploadMesh upload;
  upload.name = params.label("name", session::max_mesh_name_bytes, std::nullopt);
  if (!params.value("obj").is_string()) params.refuse("obj", "a string");
  const std::string encoding = params.text("encoding", "text");
  if (encoding != "text" && encoding != "base64") params.refuse("encoding", "text or base64");
  if (auto error = params.check()) return *error;
  upload.in_base64 = encoding == "base64";
  upload.bytes = std::move(request.params["obj"].get_ref<std::string&>());
  upload.in_hand = client.begin_upload();
  if (!upload.in_hand)
    return RpcError{error_over_limit, "a mesh of yours is being read; wait for its answer", nullptr};
  return ask_session(client, request, std::move(upload));
}

}  // namespace clothlab::net
