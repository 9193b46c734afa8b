#include "app/report/page/page_html.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>

#include "app/report/page/web_files.hpp"
#include "engine/core/error.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

std::string three_js() {
  const char* const given = std::getenv("SULCUS_THREE_JS");
  const std::string file = given ? given : "/usr/share/javascript/three/three.min.js";
  std::ifstream in(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(in), {});
  if (text.empty()) {
    throw InputError(file, "", "no three.js", "it, for the page's view: apt install libjs-three");
  }
  return text;
}

std::string json_for_html(const nlohmann::ordered_json& data) {
  const std::string json =
      data.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {  // stands in strings alone
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string page_html(const std::string& title, const std::string& body,
                      const nlohmann::ordered_json& data, const std::string& three) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; media-src data:; form-action "
      "'none'; base-uri 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<link rel=\"icon\" "
      "href=\"data:,\">\n<title>" +
      for_html(title) + "</title>\n<style>\n";
  page.append(page_css()).append("</style></head><body>\n").append(body);
  page.append("<script type=\"application/json\" id=\"sulcus-data\">");
  page.append(json_for_html(data)).append("</script>\n<script>").append(three);
  page.append("</script>\n<script>\n'use strict';\n").append(page_script());
  return page + "</script>\n</body></html>\n";
}

std::string row_of(const std::string& name, const std::string& value) {
  return "<tr><th>" + for_html(name) + "</th><td>" + for_html(value) + "</td></tr>\n";
}

}  // namespace sulcus
