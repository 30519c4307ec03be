// The page's files, all in memory from the start: nothing outside web/dist can be reached, and nothing is
// compressed twice.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace clothlab::net {

struct WebFile {
  std::string type;  ///< of the content, with its charset
  std::string body;
  std::string gzipped;  ///< empty where it would not be smaller
  std::string etag;     ///< quoted
};

class WebFiles {
 public:
  /// Loads every file below the page's folder. Without it there is one page, which says how to build the real
  /// one.
  static WebFiles load();

  /// By path, "/" being the page; null if there is none.
  const WebFile* find(const std::string& path) const;
  bool built() const { return built_; }

 private:
  void add(const std::string& path, std::string body);

  std::map<std::string, WebFile> files_;
  bool built_ = false;
};

}  // namespace clothlab::net
