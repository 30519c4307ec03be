// Pages that are complete in one file: a file of the built web page, with places for what they show.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/base/result.h"

namespace clothlab {

/// `text` as the content of an HTML element.
std::string as_html(const std::string& text);

/// The file web/dist/`name`, in which each place, e.g. "@title@", has its text. Error: the web page has not
/// been built.
Result<std::string> filled_page(const std::string& name,
                                const std::vector<std::pair<std::string, std::string>>& texts);

}  // namespace clothlab
