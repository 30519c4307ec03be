#include "server/session/automatic.h"

#include "server/lab/measure/automatic.h"

namespace clothlab::session {

Result<scene::Scene> Automatic::settle(const scene::Document& document, Clock::time_point now) {
  if (!document.scene.solver.automatic) {
    in_use_.reset();
    due_.reset();
    return document.scene;
  }
  covered_ = choice_ && lab::covers(choice_->measured, document.value);
  if (covered_ && choice_->setting) {
    in_use_ = choice_->setting;
  } else {
    const Result<model::Model> model = model::build(document.scene);
    if (!model) return model.error();
    in_use_ = lab::provisional(*model, document.scene);
  }
  due_.reset();
  if (!covered_) due_ = now + quiet;
  return lab::with(document.scene, *in_use_);
}

bool Automatic::wants_choice(Clock::time_point now) {
  if (!due_ || now < *due_) return false;
  due_.reset();
  return true;
}

void Automatic::take(const scene::Document& measured, const Result<lab::Choice>& choice) {
  choice_ = Choice{measured.value, {}, {}};
  if (!choice) {
    choice_->facts = {{"state", "failed"}, {"why", choice.error().text()}};
    return;
  }
  const lab::Point& chosen = choice->chosen;
  choice_->setting = chosen.setting;
  choice_->facts = {{"state", "chosen"},
                    {"met", choice->met},
                    {"expected_error", chosen.largest_position_error.value_or(0.0)},
                    {"expected_ms_a_simulated_s", chosen.cost ? json(chosen.cost->median) : json()},
                    {"why", choice->why}};
}

json Automatic::facts() const {
  if (!in_use_) return nullptr;
  json facts =
      covered_ ? choice_->facts
               : json{{"state", "measuring"}, {"why", "stable settings are used until the lab has chosen"}};
  facts.update(lab::to_json(*in_use_));
  return facts;
}

}  // namespace clothlab::session
