// Publishes a session on a bus for relays (server/relay): what viewers get, once for all of them, and only
// while a relay wants it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "server/bus/bus.h"
#include "server/net/json_rpc.h"
#include "server/net/outbox.h"
#include "server/net/want_guard.h"
#include "server/relay/audience.h"
#include "server/stream/frame.h"

namespace clothlab::net {

class Publisher {
 public:
  /// `origin` names this run of the server: relays that know another one ask for everything anew.
  Publisher(bus::Bus& bus, std::string session, std::string origin);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  relay::Audience& audience() { return audience_; }
  const relay::Audience& audience() const { return audience_; }

  /// All that a viewer gets when it enters.
  struct State {
    const std::string& renderer;
    const json& document;
    std::uint64_t revision;
    const json& history;
    const stream::SharedMessage& topology;
  };
  /// True if a relay's request may be read, so that many of them do not stop the session's server.
  bool may_ask(const std::string& reply, std::int64_t now) { return guard_.take(reply, now); }
  /// Answers a relay's want with what is new to it.
  void answer(const relay::Want& want, const std::string& reply, const State& state);
  /// Answers with the mesh of a collider, empty: there is none.
  void answer_collider(const std::string& name, const std::string& reply, std::string mesh);
  void heard(const relay::Want& want, std::int64_t now);
  struct AudienceChange {
    bool forms = false, viewers = false;
    std::array<bool, relay::form_count> fresh{};  ///< forms of which a relay needs a frame at once
  };
  /// How the audience has changed since the last call; told ten times a second at most.
  AudienceChange audience_change(std::int64_t now);
  /// The scene, or its history, has changed.
  void forget_whole() { whole_ = {}; }

  void text(const SharedText& text);
  void topology(const stream::SharedMessage& topology);
  void frame(const stream::SharedMessage& frame);

 private:
  const bus::Bytes& whole(const State& state);
  void send(std::string subject, const stream::SharedMessage& message, std::string note, bus::Keep keep);

  bus::Bus& bus_;
  std::string session_, origin_;
  relay::Audience audience_;
  WantGuard guard_;
  bus::Bytes whole_;  ///< the answer to who knows nothing, made once for all
  std::array<bool, relay::form_count> fresh_{};
  relay::Rates rates_told_{};
  int viewers_told_ = 0;
  std::int64_t tell_at_ = 0;  ///< [us]
};

}  // namespace clothlab::net
