#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

// The commands of sulcus-lab, each as its --help tells. Their callbacks throw InputError (status 2)
// or another std::exception (status 1).

/// Surfaces that carry their filled fraction beside binary ones: errors, grain, volumes, times.
void add_fractions_command(CLI::App& program);
/// How fluently a run at real pace is drawn, and what drawing it costs its ticks.
void add_frames_command(CLI::App& program);
/// The laws of the force: no history, no favoured axis, no energy from nowhere.
void add_laws_command(CLI::App& program);
/// Errors and times of the normal methods on shapes whose normals are known.
void add_normals_command(CLI::App& program);
/// What a tick costs against how true its force is, on the molar.
void add_pareto_command(CLI::App& program);
/// What the whole program takes: its start, memory, pictures, large scenes, its build.
void add_program_command(CLI::App& program);
/// What others measured in mouths and on rigs, beside what Sulcus gives.
void add_reality_command(CLI::App& program);
/// What a recording survives, and how fast it is gone through.
void add_recordings_command(CLI::App& program);
/// Where haptic methods fail, and where ours is held to a limit.
void add_stability_command(CLI::App& program);
/// Table 1 and figs. 5 and 6 of Kim and Park (2019) from one run.
void add_table1_command(CLI::App& program);
/// Time of a whole tick against the voxels in contact.
void add_ticks_command(CLI::App& program);

}  // namespace sulcus::lab
