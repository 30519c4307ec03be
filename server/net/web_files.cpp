#include "server/net/web_files.h"

#include <array>
#include <cstdint>

#include "server/base/data_files.h"
#include "server/base/deflate.h"
#include "server/base/files.h"
#include "server/base/text.h"

namespace clothlab::net {

namespace fs = std::filesystem;

namespace {

constexpr const char* brotli_extension = ".br";  ///< of what web/build.mjs writes beside a file
constexpr const char* not_built = R"(<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Clothlab</title>
<h1>The page has not been built</h1>
<p>The server runs, and scripts can talk to it at <code>/ws</code>. To build the page, run this in the project's
folder, then start the server again:</p>
<pre>npm --prefix web ci &amp;&amp; npm --prefix web run build</pre>
<p>or start the server with <code>server/run</code>, which builds everything.</p>
</html>
)";

std::string type_of(const std::string& path) {
  static constexpr std::array<std::array<const char*, 2>, 15> types{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".webp", "image/webp"},
      {".ico", "image/x-icon"},
      {".wasm", "application/wasm"},
      {".woff2", "font/woff2"},
      {".txt", "text/plain; charset=utf-8"},
      {".py", "text/x-python; charset=utf-8"},
  }};
  const std::string extension = fs::path(path).extension().string();
  for (const auto& [ending, type] : types)
    if (extension == ending) return type;
  return "application/octet-stream";
}

std::string etag_of(const std::string& body) {
  std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
  for (const char c : body) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return formatted("\"%016llx\"", static_cast<unsigned long long>(hash));
}

}  // namespace

void WebFiles::add(const std::string& path, std::string body, std::string brotli) {
  const std::string type = type_of(path);
  const bool packed_already = type.rfind("image/", 0) == 0 && type != "image/svg+xml";
  std::string gzipped = packed_already ? std::string() : gzip(body);
  if (gzipped.size() >= body.size()) gzipped.clear();
  std::string etag = etag_of(body);
  files_[path] = {type, std::move(body), std::move(gzipped), std::move(brotli), std::move(etag)};
}

void WebFiles::add_all(const fs::path& root, const fs::path& below) {
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root, failure)) {
    if (entry.is_symlink(failure) || !entry.is_regular_file(failure)) continue;
    if (entry.path().extension() == brotli_extension) continue;
    const Result<std::string> brotli = read_file(entry.path().string() + brotli_extension);
    if (Result<std::string> body = read_file(entry.path()))
      add((below / entry.path().lexically_relative(root)).generic_string(), std::move(*body),
          brotli ? *brotli : std::string());
  }
}

WebFiles WebFiles::load() {
  WebFiles files;
  if (const Result<fs::path> root = data_path("web/dist")) files.add_all(*root, "/");
  if (const Result<fs::path> root = data_path("web/pictures")) files.add_all(*root, "/presets");
  for (const char* client : {"clothlab.py", "clothlab.mjs"})
    if (const Result<fs::path> path = data_path(std::string("web/clients/") + client))
      if (Result<std::string> body = read_file(*path)) files.add(std::string("/") + client, std::move(*body));
  files.built_ = files.files_.count("/index.html") > 0;
  if (!files.built_) files.add("/index.html", not_built);
  return files;
}

const WebFile* WebFiles::find(const std::string& path) const {
  const auto found = files_.find(path == "/" ? "/index.html" : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace clothlab::net
