// The files of the browser's page, as its build left them.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "protocol/web_pages.h"

namespace visum::gateway {

// All files are read into memory once, at start. A path that is not among them does not exist, so no request
// can name any other file of the machine. Constant after construction; any thread. Web owns it.
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
    std::string plain, gzip;  // gzip: as compressed by the build; empty: it was not
  };
  std::map<std::string, File> files_;  // by path, "/assets/index-B1c2D3.js"
};

// The page's folder beside this program: installed (../share/visum/page) or in the build tree (../page).
// Empty: there is neither.
std::filesystem::path find_page_folder();

}  // namespace visum::gateway
