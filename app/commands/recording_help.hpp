#pragma once

#include <string>

#include "engine/recording/recording_layout.hpp"

namespace sulcus {

/// A part of a recording as help and manual tell it: "rows, with [cutting]: one row for each ...".
std::string text_of(const StoredPart& part);
/// A column, an attribute, or the values of an array: "f64[3], m".
std::string values_of(const StoredField& field);

/// What reads a recording, in Python and MATLAB.
std::string recording_examples();
/// What holds for all of it.
std::string recording_notes();

/// The whole layout, for a terminal of 100 columns.
std::string recording_help();

}  // namespace sulcus
