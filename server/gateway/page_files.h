// The page's files, as its build left them: read once, whole, into memory. What is not among them does not
// exist, so that no request can name any other file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "protocol/web_pages.h"

namespace visum::gateway {

class PageFiles {
 public:
  PageFiles() = default;  // no page
  // Throws std::runtime_error where the folder holds no index.html, or more than a page can have.
  explicit PageFiles(const std::filesystem::path& folder);

  bool empty() const { return files_.empty(); }
  // 200, 304 or 404. The reply points into this object.
  protocol::WebReply get(const protocol::WebRequest& request) const;

 private:
  struct File {
    std::string content_type, etag;
    bool immutable = false;   // a hash of its content is in its name
    std::string plain, gzip;  // gzip: as the build compressed it; empty: it did not
  };
  std::map<std::string, File> files_;  // by path, "/assets/index-B1c2D3.js"
};

// Where the page stands beside this program: installed (../share/visum/page) or in the build tree (../page).
// Empty: in neither.
std::filesystem::path find_page_folder();

}  // namespace visum::gateway
