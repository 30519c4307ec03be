#include "server/base/page_template.h"

#include "server/base/data_files.h"
#include "server/base/files.h"

namespace clothlab {

std::string as_html(const std::string& text) {
  std::string out;
  for (const char letter : text)
    if (letter == '<')
      out += "&lt;";
    else if (letter == '&')
      out += "&amp;";
    else
      out += letter;
  return out;
}

Result<std::string> filled_page(const std::string& name,
                                const std::vector<std::pair<std::string, std::string>>& texts) {
  const std::string file = "web/dist/" + name;
  const Error not_built{file, "the web page has not been built",
                        "run `npm --prefix web ci` and `npm --prefix web run build`"};
  const Result<std::filesystem::path> path = data_path(file);
  if (!path) return not_built;
  Result<std::string> page = read_file(*path);
  if (!page) return page.error();
  for (const auto& [place, text] : texts) {
    const std::size_t at = page->find(place);
    if (at == std::string::npos) return not_built;
    page->replace(at, place.size(), text);
  }
  return page;
}

}  // namespace clothlab
