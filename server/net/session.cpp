#include "server/net/session.h"

#include <exception>

#include "server/gl/context.h"
#include "server/net/stepper.h"

namespace clothlab::net {

Session::Session(scene::Document document, std::optional<int> gpu, std::function<void()> wake)
    : exchange_(std::move(wake)) {
  exchange_.beat();
  thread_ = std::thread([this, gpu, document = std::move(document)]() mutable {
    try {
      run(exchange_, std::move(document), gpu);
    } catch (const std::exception& error) {
      exchange_.emit(
          Failed{{"session", error.what(), "load the scene again; please report it if it happens twice"}});
    }
  });
}

Session::~Session() {
  exchange_.stop();
  thread_.join();
}

void Session::run(Exchange& exchange, scene::Document document, std::optional<int> gpu) {
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create(gpu);
  if (!context) return exchange.emit(Failed{context.error(), true});
  Result<std::unique_ptr<Stepper>> stepper = Stepper::create(std::move(document), exchange);
  if (!stepper) return exchange.emit(Failed{stepper.error()});
  exchange.emit(Started{(*context)->device().name});
  std::vector<Command> commands;
  Clock::time_point next = Clock::now();
  while (exchange.take_commands(commands, next)) next = (*stepper)->turn(commands);
}

}  // namespace clothlab::net
