// A session of another server, as the bus brings it: what a relay shows. It takes the place of a session's
// thread (session/exchange.h): events and frames out; of the commands in only those that a viewer of a relay
// may cause.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/memory_budget.h"
#include "server/bus/bus.h"
#include "server/relay/wire.h"
#include "server/session/source.h"

namespace clothlab::relay {

class Feed final : public session::Source {
 public:
  /// The mesh of a collider as a file in the PLY format; null: there is none.
  using ColliderMesh = std::shared_ptr<const std::string>;
  using Deliver = std::function<void(std::uint64_t asker, const ColliderMesh& mesh)>;
  /// `relay` is the name of this process on the bus. `deliver` is called with each answer to ask_collider.
  /// What is kept of the session is reserved of `budget` (null: it is not bounded); what does not fit is
  /// dropped, and viewers are told.
  Feed(bus::Bus& bus, std::string session, std::string relay, Deliver deliver, std::function<void()> wake,
       std::shared_ptr<MemoryBudget> budget = nullptr);
  ~Feed() override;
  bool beats() const override { return true; }

  /// Carries out the commands that wait, and tells the server what is wanted; `now` is the time [us]. To be
  /// called at least a few times a second.
  void pump(std::int64_t now);
  void receive(const bus::Message& message, std::int64_t now);
  /// The mesh of the collider of this name, null: the server must be asked for it.
  ColliderMesh collider(const std::string& name) const;
  void ask_collider(const std::string& name, std::uint64_t asker);

  /// Without an answer for this long the server is told to be silent; a session that has none by then fails
  /// [us].
  static constexpr std::int64_t patience_us = 5'000'000;

 private:
  void carry_out(session::Command& command, std::int64_t now);
  void set_viewers(int viewers);
  void set_rates(const Rates& rates);
  void send_want(std::int64_t now);
  void want_soon(std::int64_t now);
  void heard(std::int64_t now);
  void look_for_silence(std::int64_t now);
  void take_answer(const bus::Message& message, std::int64_t now);
  void take_state(const json& state, std::int64_t now);
  void origin_changed(std::int64_t now);
  void take_text(const bus::Message& message, std::int64_t now);
  void take_status(json status);
  void take_scene(json document, std::uint64_t revision, bool told);
  void tell_scene(std::optional<json> patch, std::uint64_t by, bool told);
  void take_patch(const json& params, std::int64_t now);
  void take_topology(const std::vector<std::uint8_t>& bytes);
  void take_frame(const bus::Message& message, stream::Form form, std::int64_t now);
  void forget_colliders();
  void take_collider(const std::string& quoted_name, const std::vector<std::uint8_t>& bytes);
  void tell(const char* level, const std::string& text);
  bool keep(MemoryBudget::Reservation& memory, std::size_t bytes);

  bus::Bus& bus_;
  std::shared_ptr<MemoryBudget> budget_;
  MemoryBudget::Reservation document_memory_{}, topology_memory_{}, colliders_memory_{};
  std::array<MemoryBudget::Reservation, form_count> frame_memory_{};
  bool told_of_memory_ = false;  ///< that something was dropped for lack of it
  std::string session_;
  Want want_;
  Deliver deliver_;
  std::int64_t begun_ = 0, heard_ = 0;      ///< when made, and when the server answered last [us]
  std::int64_t wanted_ = 0, want_due_ = 0;  ///< when the want was sent last, and when it is due [us]
  bool started_ = false, failed_ = false, silent_ = false;
  std::optional<std::int64_t> origin_changed_;  ///< when another server answered than before [us]
  bool told_of_two_ = false;                    ///< that two servers publish the session

  std::string renderer_;
  json document_;
  session::JsonText scene_text_ = session::text_of(nullptr);  ///< as of session::SceneChanged
  std::uint64_t revision_ =
      0;  ///< of `document_`; `want_.known.revision` is that of the last one told as a whole

  // Topologies and frames are numbered anew, because the numbers of a server that was restarted start again.
  stream::SharedMessage topology_;
  std::vector<std::uint8_t> their_topology_;
  std::uint32_t last_frame_ = 0, frame_offset_ = 0;
  bool topology_fits_ = false;  ///< there was memory for the newest
  bool renumber_ = true;        ///< the next frame follows the last one, whatever its number

  std::map<std::string, ColliderMesh> colliders_;
  struct Asked {
    std::vector<std::uint64_t> askers;
    std::int64_t at = 0;  ///< when the server was asked last [us]
  };
  std::map<std::string, Asked> asked_;  ///< by the collider's name
};

}  // namespace clothlab::relay
