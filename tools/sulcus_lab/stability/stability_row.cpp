#include "tools/sulcus_lab/stability/stability_row.hpp"

#include <cstdio>

namespace sulcus::lab {

StabilityRow case_row(std::string_view name, ContactMethod method, std::string_view quantity,
                      std::string_view setting, double value, std::optional<double> limit,
                      bool at_least) {
  StabilityRow row;
  row.case_name = name;
  row.method = method;
  row.quantity = std::string(quantity) + (setting.empty() ? "" : ": ") + std::string(setting);
  row.value = value;
  row.limit = limit;
  row.at_least = at_least;
  return row;
}

std::string with_number(const char* form, double number) {
  char text[128];
  std::snprintf(text, sizeof text, form, number);
  return text;
}

}  // namespace sulcus::lab
