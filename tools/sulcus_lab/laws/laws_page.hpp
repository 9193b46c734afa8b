#pragma once

#include <span>
#include <string>

#include "tools/sulcus_lab/laws/law_row.hpp"

namespace sulcus::lab {

/// The page laws.html: laws against scalings, then each law with what was measured of it. One file
/// of HTML without scripts. `rows`: in any order; a law without rows was not run. `picture`: its
/// file name relative to the page; empty: none was drawn. `remark`: a paragraph for the end, as the
/// build. All text is escaped.
std::string laws_page(std::span<const LawRow> rows, const std::string& picture,
                      const std::string& remark);

}  // namespace sulcus::lab
