#include "tools/sulcus_lab/laws/laws.hpp"

#include <algorithm>

namespace sulcus::lab {

namespace {

constexpr Law kLaws[] = {
    {"at_rest", "A tool at rest feels the same force",
     "The tool comes down to a place and stays there for a hundred ticks.",
     "the force of the second tick to the bit, with and without the normal cache", at_rest},
    {"another_way", "The same pose, reached another way",
     "A place is reached along the normal, along the surface from three sides, and out of a deeper "
     "place.",
     "the same bits, in the tick of the arrival and in the one after it", another_way},
    {"symmetries", "The 48 symmetries of the grid",
     "Solid and tool are turned and mirrored voxel by voxel, and the force is taken back.",
     "within 0.00001 N, the same contacts", symmetries},
    {"turned_cut", "A cut turned by the 24 rotations of the grid",
     "A turning burr is drawn along an edge; solid and way are turned.",
     "the same voxels go, with fractions the same share of each, but for 3 in 10,000", turned_cut},
    {"closed_way", "A closed way gives out no energy",
     "The tool goes round a circle across an edge, without friction or cutting. What it is given "
     "by the force on a whole turn, against the most that it had put in.",
     "under potential at most 0.5 % of what is stored, either way round", closed_way},
    {"coupled_way", "The same through the coupling",
     "The device goes round the circle, the tool hangs on its springs.",
     "under potential at most 0.2 \u00b5J a turn", coupled_way},
    {"device_way", "The same through the simulated device",
     "A hand takes a simulated device round. Energy is that of the handle's own motion under the "
     "force that it holds, in the mean of the turns.",
     "with the passivity controller none, under every scaling", device_way},
    {"two_bodies", "One solid as two bodies that meet at a face",
     "A solid is cut apart at a face of voxels into two bodies. The burr slides over the seam, and "
     "cuts along it.",
     "force, its part across the seam, and the volume removed within 1 % of the one solid's",
     two_bodies},
    {"cutting_balance", "Energy is spent where it was worked",
     "A burr at 300,000 rpm goes from a soft tissue on to enamel. What was removed, is stored in "
     "part-cut voxels and was lost as heat is the work; a tissue gets no more than was worked at "
     "it.",
     "all of the work accounted for; nothing spent on enamel that was worked elsewhere",
     cutting_balance},
    {"removed_and_voxels", "What is removed does not depend on the voxel size",
     "A push of 1 N for 10 s, scenes/side_cut.toml.",
     "with fractions within 1 % of the finest; of whole voxels only reported", removed_and_voxels},
    {"stiffness_and_voxels", "Stiffness does not depend on the voxel size",
     "The force of a ball in a plane, against the integral of the law over the ball.",
     "within 5 % with voxels of up to 0.1 mm", stiffness_and_voxels},
    {"jump_and_silence", "A jump or a silence cuts nothing",
     "The device jumps by 20 mm into contact, or is silent and comes back elsewhere, the spindle "
     "standing.",
     "no voxel goes, no friction is felt", jump_and_silence},
    {"long_steps", "A step too long for what it meets is reported",
     "The tool is drawn through a block in steps of up to 2 mm, and through a wall of one voxel.",
     "a fault is set where more than 5 % less is cut or the wall is crossed, none at 0.02 mm a "
     "tick",
     long_steps},
    {"free_slide", "A free slide costs nothing",
     "Behind the coupling, pressed with 0.7 N, no friction: the force along a plane.",
     "at most 0.01 N on a plane; 250 Hz within 0.02 N of 1 kHz", free_slide},
    {"quiet_controller", "The passivity controller is quiet",
     "What it adds to the coupling's force in scenes/hand_cut.toml, from tick to tick.",
     "steps of at most 0.02 N", quiet_controller},
    {"groove_direction", "In a symmetric groove the force is along its bisector",
     "A ball lies in the middle of a V that is turned about its own and the vertical axis.",
     "within 0.3 degrees, in the mean along the groove", groove_direction},
};

}  // namespace

std::span<const Law> laws() { return kLaws; }

std::vector<LawRow> measure_law(std::string_view name, const LawOptions& options) {
  const Law& law = *std::ranges::find(kLaws, name, &Law::name);
  std::vector<LawRow> rows;
  LawTrial trial(law.name, options, rows);
  law.measure(trial);
  return rows;
}

}  // namespace sulcus::lab
