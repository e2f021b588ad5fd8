// The forms of a comparison: a line of JSON, text for people, an HTML page. Pure functions.
#pragma once

#include <string>

#include "clients/visum/compare/campaigns.h"
#include "clients/visum/compare/recordings.h"

namespace visum::compare {

// {"equal","first_tick","ports":[{"port","tick","a","b","max_abs"}],"checks":[...], ...}
std::string as_json(const RecordingComparison& of);
std::string as_json(const CampaignComparison& of);
std::string as_text(const RecordingComparison& of);
std::string as_text(const CampaignComparison& of);
// `a`, `b`: names of the two.
std::string as_html(const RecordingComparison& of, const std::string& a, const std::string& b);
std::string as_html(const CampaignComparison& of, const std::string& a, const std::string& b);

}  // namespace visum::compare
