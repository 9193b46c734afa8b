#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace sulcus {

/// three.js in one file, as Debian's libjs-three has it; `SULCUS_THREE_JS` names another one.
/// InputError where it is not there, with the package to install: known before any work.
std::string three_js();

/// A whole page: it opens from the disk, and its Content-Security-Policy lets nothing leave it.
/// `title`: text; `body`: HTML, in which viewer_html() stands once; `data`: what Viewer reads;
/// `three`: of three_js().
std::string page_html(const std::string& title, const std::string& body,
                      const nlohmann::ordered_json& data, const std::string& three);

/// JSON for within <script>: no text in it can end the element.
std::string json_for_html(const nlohmann::ordered_json& data);

/// A row of a table of facts.
std::string row_of(const std::string& name, const std::string& value);

}  // namespace sulcus
