#pragma once

#include <string_view>

namespace sulcus {

// Files of page/web/, as they were when the program was built.

/// How pages look.
std::string_view page_css();
/// The element that Viewer fills.
std::string_view viewer_html();
/// What runs on a page, after three.js: the view, and what else a page does.
std::string_view page_script();

}  // namespace sulcus
