#include "server/net/greeting.h"

#include <nlohmann/json.hpp>

#include "server/net/client.h"
#include "server/net/hub.h"
#include "server/net/limits.h"
#include "server/net/methods.h"
#include "server/scene/document.h"
#include "server/scene/method.h"
#include "server/session/history.h"
#include "server/sim/kept_states.h"
#include "server/stream/form.h"

namespace clothlab::net {

namespace {

nlohmann::json method_list() {
  auto list = nlohmann::json::array();
  for (const scene::Method method : scene::methods) list.push_back(scene::name(method));
  list.push_back(scene::automatic_method);
  return list;
}

nlohmann::json field_list() {
  auto list = nlohmann::json::array();
  for (const stream::FieldFacts& field : stream::fields) list.push_back(field.name);
  return list;
}

nlohmann::json encoding_list() {
  auto list = nlohmann::json::array();
  for (const stream::EncodingFacts& encoding : stream::encodings) list.push_back(encoding.name);
  return list;
}

}  // namespace

nlohmann::json hello_params(const Hub& hub, const Room& room, const Client& client) {
  const Limits& limits = hub.limits();
  return {
      {"server", "clothlab"},
      {"version", CLOTHLAB_VERSION},
      {"session", room.name()},
      {"role", name(client.role())},
      {"client", client.id()},  // `by` in the scene.changed of this client's edits
      {"renderer", room.renderer()},
      {"methods", method_list()},
      {"requests", method_names(hub.relays())},
      {"relay", hub.relays()},
      {"untouched", room.untouched()},
      {"encodings", encoding_list()},
      {"fields", field_list()},
      {"limits",
       {{"message_bytes", limits.message_bytes},
        {"json_depth", limits.json_depth},
        {"messages_per_second", limits.message_rate},
        {"message_burst", burst_of(limits)},
        {"sessions", limits.sessions},
        {"clients", limits.clients},
        {"clients_per_address", limits.clients_per_address},
        {"vertices", limits.scene.vertices},
        {"springs", limits.scene.springs},
        {"document_bytes", scene::max_document_bytes},
        {"idle_seconds", limits.idle_seconds},
        {"rate", max_rate},
        {"in_flight", max_in_flight},
        {"steps", max_steps},
        {"speed", {session::min_speed, session::max_speed}},
        {"meshes",
         {{"message_bytes", session::max_upload_bytes},
          {"count", session::max_meshes},
          {"bytes", session::max_mesh_bytes}}},
        {"timeline", {{"states", sim::KeptStates::most_states}, {"bytes", limits.scene.past_bytes / 4 * 3}}},
        {"history", {{"changes", session::max_changes}, {"bytes", limits.scene.past_bytes / 4}}},
        {"recording",
         {{"bytes", limits.scene.recording_bytes},
          {"rate", {session::min_recording_rate, session::max_recording_rate}}}},
        {"lab",
         {{"jobs", max_lab_jobs},
          {"seconds", limits.lab_seconds},
          {"jobs_a_client", max_lab_jobs_a_client},
          {"time", {min_lab_time, max_lab_time}},
          {"budget", {min_lab_budget, max_lab_budget}},
          {"comparison",
           {{"bytes", lab::max_comparison_bytes},
            {"vertices", lab::max_compared_vertices},
            {"rate", {min_comparison_rate, max_comparison_rate}}}}}}}}};
}

}  // namespace clothlab::net
