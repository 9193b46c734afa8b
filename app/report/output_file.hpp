#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace sulcus {

// What a command is to write, looked at before the work: who mistypes waits for nothing. An empty
// name is one that was not given: nothing is to be written there.

/// A file's name ends in one of `endings` (".png", in small letters; the file's in any case), and
/// it could be written. `option` names it in the message.
/// @throws InputError; std::runtime_error where the disk is full.
void check_output(const std::string& option, const std::string& file,
                  std::initializer_list<std::string_view> endings);

/// An option that names a file to be written, and that file.
struct OutputOption {
  std::string option, file;
};
/// No two of them name one file. @throws InputError.
void check_outputs_differ(std::span<const OutputOption> outputs);

/// A folder is there and can be written into, or can be made. @throws InputError.
void check_output_folder(const std::string& option, const std::string& folder);

/// Makes a folder, and those that it lies in. @throws InputError where it cannot be made;
/// std::runtime_error where the disk is full.
void make_output_folder(const std::string& option, const std::string& folder);

}  // namespace sulcus
