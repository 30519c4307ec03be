#include "server/net/full_note.h"

#include <sstream>

namespace clothlab::net {

std::string full_of_clients(int most) {
  return "clients " + std::to_string(most) + "\n";
}

std::string full_of_address(const std::string& network, int most) {
  return "address " + std::to_string(most) + " " + network + "\n";
}

std::string refusal_by_note(const std::string& note, const std::string& network) {
  std::istringstream lines(note);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, of;
    int most = 0;
    if (!(words >> kind >> most)) continue;
    if (kind == "clients")
      return "the server that has this session open has as many clients as it may, " + std::to_string(most) +
             "; see --max-clients";
    if (kind == "address" && words >> of && of == network)
      return "this address has as many clients as it may, " + std::to_string(most) +
             ", on the server that has this session open; see --max-clients-per-address";
  }
  return "another server has this session open; connect again";
}

}  // namespace clothlab::net
