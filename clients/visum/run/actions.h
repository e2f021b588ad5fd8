// Carries out the actions of the time line, by requests to the daemon and signals to the controllers. Main
// thread; the runner owns it. What it refers to must outlive it.
#pragma once

#include <functional>
#include <string>

#include "clients/visum/run/controllers.h"
#include "clients/visum/run/session.h"

namespace visum::run {

class Actions {
 public:
  using OnSay = std::function<void(const std::string& text)>;
  Actions(Session& session, Controllers& controllers, const Catalogue& catalogue, OnSay on_say)
      : session_(session), controllers_(controllers), catalogue_(catalogue), on_say_(std::move(on_say)) {}

  // Throws ExitError(kFailed) if the server refuses; the message names the place in the scenario.
  void perform(const TimelineEntry& entry);

 private:
  void perform(const SetPort& set);
  void perform(const Push& push);
  void perform(const SetParameter& set);
  void perform(const InjectFault& fault);
  void perform(const ClearFault& clear) {
    session_.request(protocol::ClearFault{clear.part, clear.kind, static_cast<std::uint32_t>(clear.joint)});
  }
  void perform(const Signal& signal) { controllers_.signal(signal.controller, signal.number); }
  void perform(const RemoveBody& remove) { session_.request(protocol::RemoveBody{remove.body}); }
  void perform(const Say& say) { on_say_(say.text); }

  Session& session_;
  Controllers& controllers_;
  const Catalogue& catalogue_;
  OnSay on_say_;
};

}  // namespace visum::run
