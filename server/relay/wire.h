// What a server and its relays say to each other over a bus: README.md here. Pure functions of text.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "server/stream/form.h"

namespace clothlab::relay {

using nlohmann::json;
using stream::form_count;

// The subjects of a session.
std::string subject(const std::string& session, std::string_view what);
inline constexpr const char* want_word = "want";          ///< requests: what a relay wants
inline constexpr const char* collider_word = "collider";  ///< requests: the mesh of a collider
inline constexpr const char* text_word = "text";          ///< notifications, as viewers get them
inline constexpr const char* topology_word = "topology";
/// The subject of frames of this form: clothlab.SESSION.q16, or clothlab.SESSION.q16.strain.
std::string frame_subject(const std::string& session, stream::Form form);
/// Where one relay gets its answers.
std::string answer_subject(const std::string& session, const std::string& relay);
/// The session that a subject belongs to; empty: it is none of ours.
std::string session_of(std::string_view subject);

/// The frames that are wanted of each form [1/s], at its index; 0: none.
using Rates = std::array<double, form_count>;

/// What a relay has of a session, so that only what is new to it is told.
struct Known {
  std::string origin;  ///< the run of the server that told it; empty: nothing is known
  std::uint64_t revision = 0;
  std::uint32_t topology = 0;
};

/// A relay's request, sent each second and whenever it changes.
struct Want {
  std::string relay;
  int viewers = 0;
  Rates rates{};
  Known known;
};
std::string text_of(const Want& want);
/// Compact JSON; what is no UTF-8 in it is replaced.
std::string text_of(const json& value);
/// The value of a text of the bus; null: it is no JSON, or too long or deep for a document that is served.
json value_of(std::string_view text);
/// No value: the text is no such request.
std::optional<Want> read_want(std::string_view text);

/// The most frames a second that a want can ask for, and viewers that it can tell; more are taken for these.
inline constexpr double most_rate = 120;
inline constexpr int most_viewers = 1'000'000;

/// The lease of a want: without another one for this long a relay is taken for gone [us].
inline constexpr std::int64_t lease_us = 3'500'000;
inline constexpr std::int64_t want_period_us = 1'000'000;

/// The most relays of one session; a want of another one is ignored.
inline constexpr std::size_t max_relays = 1000;

}  // namespace clothlab::relay
