// Follows the heads of requests in the bytes that come from one connection, before libwebsockets reads them.
#pragma once

#include <cstddef>
#include <string>

namespace clothlab::net {

/// libwebsockets 4.1 to 4.3 loses a header whose name begins a known one (X-Auth, Accept-CH), and a line
/// without a colon, with all that follows up to the next colon, often the head's end too, so that the request
/// is never answered; a name that begins with a method (Put-After) ends the connection. All are changed into
/// headers that it ignores.
class HeadWatch {
 public:
  /// Inspects the next `size` bytes of the connection, and changes what libwebsockets would not understand.
  /// Returns the number of bytes then in `data`, which has space for `room` bytes.
  std::size_t filter(unsigned char* data, std::size_t size, std::size_t room);
  /// True if a line of a head had no colon.
  bool malformed() const { return malformed_; }
  /// True if bytes have come after a head that asks for another protocol, without waiting for its answer.
  bool hurried() const { return hurried_; }

 private:
  enum class Part { request, name, value };

  /// Takes in the byte at `at`; true if another one must be put before it.
  bool take(unsigned char* data, std::size_t at);
  bool end_of_name(unsigned char* data, std::size_t at);
  void end_of_line(unsigned char* data, std::size_t at);

  Part part_ = Part::request;
  std::string name_;  ///< of the present line, lower case; longer ones than any known are cut
  std::size_t line_bytes_ = 0;
  bool upgrade_ = false, upgraded_ = false;  ///< the present head, or one before, asks for another protocol
  bool malformed_ = false, hurried_ = false;
};

}  // namespace clothlab::net
