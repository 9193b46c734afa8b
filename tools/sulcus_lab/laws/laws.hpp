#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "tools/sulcus_lab/laws/law_trial.hpp"

namespace sulcus::lab {

/// A law of the force, and its measurement.
struct Law {
  std::string_view name;
  std::string_view title, text, wanted;  // for readers of the page
  void (*measure)(LawTrial&);
};
/// All, in the order of the page.
std::span<const Law> laws();
/// The rows of one of them.
std::vector<LawRow> measure_law(std::string_view name, const LawOptions& options);

// laws_of_place.cpp: the force is a function of shape, pose and motion.
void at_rest(LawTrial& trial);
void another_way(LawTrial& trial);
// laws_of_symmetry.cpp
void symmetries(LawTrial& trial);
void turned_cut(LawTrial& trial);
// laws_of_energy.cpp
void closed_way(LawTrial& trial);
void coupled_way(LawTrial& trial);
void device_way(LawTrial& trial);
// laws_of_bodies.cpp
void two_bodies(LawTrial& trial);
// laws_of_cutting.cpp
void cutting_balance(LawTrial& trial);
void removed_and_voxels(LawTrial& trial);
void jump_and_silence(LawTrial& trial);
void long_steps(LawTrial& trial);
// laws_of_stiffness.cpp
void stiffness_and_voxels(LawTrial& trial);
void groove_direction(LawTrial& trial);
// laws_of_hands.cpp
void free_slide(LawTrial& trial);
void quiet_controller(LawTrial& trial);

}  // namespace sulcus::lab
