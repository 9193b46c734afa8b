#include "tools/sulcus_lab/stability/cases/case_texts.hpp"

#include <iterator>

namespace sulcus::lab {

namespace {

constexpr CaseText kCaseTexts[] = {
    {"thin_wall", "A thin wall is popped through",
     "Pressed hard against a thin wall, the burr sinks in until it touches voxels of the far "
     "side as well. Their normals point the other way, the two sides cancel, the force "
     "collapses, and the tool drops through a wall that should have held it.",
     "Flat walls of 1, 2, 3, 6 and 12 voxels. The device goes slowly into the wall, until the "
     "coupling is stretched to the largest force the device can give.",
     "The force rises up to the device's limit, and on the way never falls back by more than "
     "0.01 N."},
    {"thin_wall_stiffness", "A thin wall feels too soft",
     "Even where a thin wall holds, its far side takes part of the force away, and the more the "
     "thinner it is, so that a thin rim of enamel feels like rubber.",
     "The same walls, with the tool held 0.1 mm deep in them, beside a wall that is thick.",
     "At least 90 % of the thick wall's force."},
    {"tunnelling", "A fast tool goes through a plate",
     "Contact is looked for where the tool is at each tick. A tool that is before a plate in one "
     "tick and behind it in the next was never seen to touch it.",
     "A plate of 0.3 mm, crossed at 10 to 1000 mm/s, starting at 16 places within a voxel.",
     "The plate is not crossed at any speed or start; the way in between is searched as soon as "
     "a step is longer than a voxel."},
    {"sticking", "The tool sticks when it is pulled back",
     "A method that remembers where the tool was, or whose normals flip at the surface, can hold "
     "on to the tool as it leaves: the tooth feels as if it were glue.",
     "Pressed 0.3 mm deep, then pulled straight back at 5 mm/s.",
     "Never a pull of more than 0.02 N towards the tooth, and no force within one tick of "
     "parting."},
    {"buzz", "A stiff contact buzzes",
     "The force is held for a millisecond while the hand moves on, which feeds energy into the "
     "loop. Above some stiffness, which depends on device, hand and delay, the tool starts to "
     "vibrate against the tooth.",
     "The closed loop of device and hand against a flat face, at 0.5 to 1.5 times the largest "
     "stiffness that is stable.",
     "Up to 0.8 of that stiffness the force's swing, peak to peak, stays under 1.5 times "
     "stiffness times device resolution; at 1.1 of it the buzz detector speaks within 50 ms."},
    {"edge_normals", "The force jerks at an edge",
     "On a ridge the two faces pull the normals their own way. As voxels enter and leave, the "
     "net direction jumps from one face to the other instead of turning.",
     "Over a ridge of 90 degrees at 10 mm/s, 0.1 mm deep.",
     "Wherever the force exceeds 0.1 N its direction turns by at most 2.5 degrees in a tick."},
    {"tilted_planes", "A tilted plane feels rough or points the wrong way",
     "A plane that does not lie along the grid is a staircase of voxels. Its steps are felt as a "
     "ripple, and the force leans to the grid's axes.",
     "Planes tilted by 0 to 45 degrees, towards many sides, slid over at a depth of 0.1 mm.",
     "Direction within 2 degrees of the plane's normal, magnitude within 5 %, peak to peak."},
    {"opposing_faces", "Opposing faces leave no normal",
     "Where voxels lie open to both sides, as in a fin or at a lone voxel, the sum of the "
     "directions to what is empty is zero, and dividing by its length gives something that is no "
     "number, or another answer each time.",
     "All 64 patterns in which the six neighbours of a voxel can be solid or empty.",
     "A normal of unit length, or the statement that there is none; the same each time."},
    {"vanishing_voxels", "Voxels in contact vanish",
     "Cutting takes voxels away that were holding the tool a tick ago. The force drops at once, "
     "and the hand feels a click for each bite.",
     "1, 10 and 50 % of the voxels in contact are removed in one tick.",
     "The force felt behind the coupling steps by at most 0.02 N. The contact's own force is "
     "reported beside it."},
    {"count_steps", "The force steps with the count of contacts",
     "Dividing the sum of forces by the number of contacts makes the force jump when a voxel "
     "enters that has hardly any depth: from one contact to two it is halved.",
     "The tool sinks in by steps of 1 um, as the contacts go from 1 to 2 and from 9 over 10 to 11.",
     "With the depth held, the jump as a voxel enters is at most 2 % of the force at 0.1 mm."},
    {"deep_inside", "Deep inside, nothing is felt, or the wrong way",
     "Only voxels at the surface are tested. A tool that is wholly inside touches none and feels "
     "nothing; one that is past the middle is pushed out on the wrong side.",
     "Depths of half the burr's radius to three times it, reached along a swept path; and a "
     "start inside the tooth.",
     "Finite, never reversed, within the device's limit, and it leads out again. A start inside "
     "is refused."},
    {"sample_and_hold", "Tapping makes energy out of nothing",
     "A force that is a tick late is too small on the way in and too large on the way out, so "
     "that each tap returns more energy than was put in.",
     "A hundred taps at 50 mm/s, with the passivity controller on, and again with it off.",
     "With the controller on, no tap gains more than 2 % of its kinetic energy; what it is with "
     "the controller off is reported."},
    {"coupling_mismatch", "The coupling does not match the device",
     "The spring between device and tool has a limit of its own. Too stiff, it buzzes in free "
     "space as well; in series with the contact it also decides how stiff the tooth can feel.",
     "Couplings of 0.25 to 1 times the loop's own limit, with tools of 1 to 100 g.",
     "No oscillation that grows; the stiffness felt is within 5 % of that of the two springs in "
     "series."},
    {"spur", "A spur or a lone voxel stops the tool",
     "One voxel left standing, by cutting or by noise in a scan, is as stiff as a wall where "
     "forces are divided by the count of contacts: the tool hits a grain and stops dead.",
     "A column one voxel wide, and a single voxel, with the device pressed 0.1 mm past it.",
     "At most 0.2 N is felt."},
    {"loose_piece", "A piece cut loose goes on pushing",
     "Cutting can part a piece from the tooth. If nobody notices, it hangs in the air and goes "
     "on holding the tool.",
     "A bridge is cut from under an island of 10 voxels each way.",
     "Within 100 ms it no longer pushes as part of the tooth, and moves as a body of its own."},
    {"wedge", "Wedged between two walls",
     "In a fissure the burr touches both walls. An error in either makes a side force, and the "
     "tool is thrown from one to the other; or the walls' forces cancel and it sinks in.",
     "V grooves of 10 to 90 degrees, and slots from one voxel narrower than the burr to one "
     "voxel wider.",
     "Side force within 5 % of symmetric and under 0.1 N peak to peak. Of the coupling's "
     "stiffness at least 0.75 is felt at 30 degrees, 0.85 at 60 and 0.9 at 90."},
    {"proxy_thrown", "The tool is thrown by a jump of the device",
     "A device that loses its count, or a tick that comes late, moves the device a long way at "
     "once. A tool that is pulled after it goes through the tooth, or comes back with all that "
     "force stored.",
     "The device jumps 50 mm into the tooth and out again; ticks of 0, 10 and 100 ms.",
     "Finite, within the device's limit, never through the tooth; at rest again within 50 ms, or "
     "placed anew by a stated rule."},
    {"overload", "Too many contacts for a tick",
     "A large burr on a fine grid touches thousands of voxels. Where that takes longer than a "
     "tick, the device goes on with an old force.",
     "1,000 to 20,000 voxels in contact.",
     "The tick keeps its time, or gives something up by a stated rule; never a force older than "
     "2 ms."},
    {"late_tick", "A tick comes late",
     "On a busy machine the loop is woken late. Velocities that are computed from the nominal "
     "time then spike, and with them damping and force.",
     "A trace of wake-ups with gaps of up to 16 ms, made from a seed.",
     "No spike of velocity, and the step of the force is capped."},
    {"cutting_energy", "Cutting does not add up",
     "Where voxels are removed by rules that do not follow from work done, what is cut depends "
     "on the voxel size and the rate, and soft tissue may cut no faster than hard.",
     "A load of 1 N cuts sideways for 10 s, with three voxel sizes and three rates, in dentine "
     "and in enamel.",
     "Energy of what was removed, what is stored and heat add up to the work within 1e-6. The work "
     "equals the power integrated apart, from the recorded tangential force, torque and speed, "
     "within 1 %. The volume is the same within 10 % over sizes and rates, and dentine cuts "
     "faster than enamel."},
};
static_assert(std::size(kCaseTexts) == 20);

}  // namespace

std::span<const CaseText> case_texts() { return kCaseTexts; }

std::span<const CaseText> other_texts() {
  static constexpr CaseText kTexts[] = {
      {"harness", "The loop that measures, checked",
       "A simulation of a haptic loop can be wrong by itself, and then says nothing about methods.",
       "The simulated device is pushed against a plain wall, a spring and a damper, without "
       "friction or quantisation, and the stiffest wall at which it comes to rest is found.",
       "Within 2 % of the stiffness at which the spectral radius of the sampled system is one, and "
       "within 10 % of the delay rule where the wall has no damping; with damping the rule leaves "
       "too much out, and is only reported."},
      {"pressed_off_axis", "A tilted burr turns the handle",
       "A tool of three degrees of freedom has no torques; one of six may turn back and forth.",
       "A round burr is pressed on a face at 30 degrees with its shank 15 degrees off the face's "
       "normal, on a device that renders torques and a hand that holds its direction by a spring.",
       "What the hand's spring holds is the torque that is felt, within 5 %; handle and turn shake "
       "by less than what the device can tell apart."},
      {"clinical_pushes", "What dentists press with, held",
       "Forces that a device can render in a stable way are a tenth of what dentists press with, "
       "unless the tool hangs on it by a spring.",
       "0.5, 1 and 2 N on faces at four tilts and at three places of the molar's sulcus, on the "
       "place and beside it, where a burr first slides down; round, fissure and flame burrs, on "
       "tips and sides; two devices, three hands, no delay and one tick; the spindle stopped, and "
       "cutting. A row has the worst of its settings.",
       "None through and none slid off; the handle shakes by less than a resolution over the last "
       "0.6 s (while cutting: about its own straight line); and from 1 N on at least 90 % of the "
       "coupling's stiffness is felt, from first contact on (only reported where a burr slides "
       "first: it shows how far) and from 1 to 2 N."},
      {"coupled_tick", "What the coupling costs",
       "It evaluates the contact several times in a tick.",
       "Burrs with about 30 and 2,000 voxels in contact slide over a face at 1 to 20 mm/s; beside "
       "it the plain tick, with the tool put at the same places.",
       "At most five plain ticks, and under a millisecond in the 99th percentile."},
      {"random_pushes", "Pushes at random",
       "Cases that somebody thought of leave out what nobody did.",
       "Places, directions, burrs and speeds of up to 100 mm/s by seeds, half of them cutting; any "
       "seed can be run by itself.",
       "Nothing crossed, nothing over the coupling's limit or not finite, and no step of over "
       "0.3 N in a tick after the first contact."}};
  return kTexts;
}

}  // namespace sulcus::lab
