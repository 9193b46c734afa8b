#pragma once

#include <span>
#include <string_view>

namespace sulcus::lab {

/// What a reader of the stability page is told of a case, as plain text. Lengths in it are those of
/// the paper's grid, voxels of 34.8 um, and a round burr of 1 mm, unless it says otherwise.
struct CaseText {
  std::string_view name;  // as in stability.csv and --case
  std::string_view title;
  std::string_view failure;  // what goes wrong in programs of this kind, and why
  std::string_view script;   // what is done here
  std::string_view limit;    // what the default method is held to
};

/// The twenty cases, in the order in which they are numbered.
std::span<const CaseText> case_texts();

/// What is measured besides, in the order of the command.
std::span<const CaseText> other_texts();

}  // namespace sulcus::lab
