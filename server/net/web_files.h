// The page's files and the clients for scripts, all read and compressed once at the start, so that requests
// reach no file outside web/dist, web/pictures and web/clients.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace clothlab::net {

struct WebFile {
  std::string type;  ///< content-type, with its charset
  std::string body;
  std::string gzipped;  ///< `body` compressed; empty where that saves nothing
  std::string brotli;   ///< the same, smaller; empty for a file that the page's build has not compressed
  std::string etag;     ///< hash of `body`, in quotes
};

class WebFiles {
 public:
  /// Loads every file below web/dist, the presets' pictures as /presets/NAME.png, and the clients. If the
  /// page was not built, "/" is a page that says how to build it.
  static WebFiles load();

  /// The file at `path`; "/" is the page, /index.html. Null if there is no such file.
  const WebFile* find(const std::string& path) const;
  bool built() const { return built_; }

 private:
  void add_all(const std::filesystem::path& root, const std::filesystem::path& below);
  void add(const std::string& path, std::string body, std::string brotli = {});

  std::map<std::string, WebFile> files_;
  bool built_ = false;
};

}  // namespace clothlab::net
