// The verbs' factories, one per file of this folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/visum/verbs/verb.h"

namespace visum::cli {

std::unique_ptr<Verb> make_parts();
std::unique_ptr<Verb> make_describe();
std::unique_ptr<Verb> make_bridge();
std::unique_ptr<Verb> make_modules();
std::unique_ptr<Verb> make_get();
std::unique_ptr<Verb> make_set();
std::unique_ptr<Verb> make_watch();
std::unique_ptr<Verb> make_params();
std::unique_ptr<Verb> make_param_set();
std::unique_ptr<Verb> make_camera();
std::unique_ptr<Verb> make_status();
std::unique_ptr<Verb> make_stop();
std::unique_ptr<Verb> make_pause();
std::unique_ptr<Verb> make_resume();
std::unique_ptr<Verb> make_step();
std::unique_ptr<Verb> make_speedup();
std::unique_ptr<Verb> make_reset();
std::unique_ptr<Verb> make_snapshot();
std::unique_ptr<Verb> make_restore();
std::unique_ptr<Verb> make_events();
std::unique_ptr<Verb> make_recording();
std::unique_ptr<Verb> make_push();
std::unique_ptr<Verb> make_pull();
std::unique_ptr<Verb> make_pose();
std::unique_ptr<Verb> make_joints();
std::unique_ptr<Verb> make_spawn();
std::unique_ptr<Verb> make_remove();
std::unique_ptr<Verb> make_scenes();
std::unique_ptr<Verb> make_load();
std::unique_ptr<Verb> make_fault();
std::unique_ptr<Verb> make_faults();
std::unique_ptr<Verb> make_run();
std::unique_ptr<Verb> make_scenario();
std::unique_ptr<Verb> make_campaign();
std::unique_ptr<Verb> make_report();
std::unique_ptr<Verb> make_compare();
std::unique_ptr<Verb> make_exec();
std::unique_ptr<Verb> make_mirror();
std::unique_ptr<Verb> make_check();
std::unique_ptr<Verb> make_drives();
std::unique_ptr<Verb> make_convert();
std::unique_ptr<Verb> make_record();
std::unique_ptr<Verb> make_replay();
std::unique_ptr<Verb> make_rewind();
std::unique_ptr<Verb> make_export();
std::unique_ptr<Verb> make_completion();

// This process becomes a server program: `words` are its name and its arguments. argv[0] stays "visum", which
// tells the program to speak of `visum VERB` in its help. Returns only by throwing ExitError.
[[noreturn]] void become_server(std::vector<std::string> words);

}  // namespace visum::cli
