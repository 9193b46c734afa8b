#pragma once

namespace sulcus::potential {

/// The law of `scaling = "potential"`, not in the paper: the energy of the whole contact, a
/// function of the tool's pose alone,
///
///   U = c sum(K a d^(p+2)) / (sum(a d^p) + S0),
///
/// over surface points with depth d inside the burr, K their tissue's stiffness, a the area that
/// each stands for. Force and torque are its exact gradient and the stiffness its second: what a
/// closed way puts in it gives back. Points and areas depend on the solid alone. A force goes along
/// the tool's gradient at its point, not along the contact normal; so nothing has to be dropped on
/// the far side of a thin wall, and no force has to be turned over an edge.
///
/// Area of a surface voxel with the normal N: voxel^2 / max(|N_x|, |N_y|, |N_z|), since a plane has
/// one voxel in each column along the axis nearest to its normal. A voxel without a normal (a lone
/// one, a plate of one voxel) has its point in the middle, half a voxel nearer to the tool, and one
/// face's area.
///
/// p = 2: a point comes in without a jump of force. With p = 1, as `smooth` weighs, it comes with
/// U / sum(a d) of its own. c is what makes a round burr on a flat face, d even over the area, as
/// stiff as under `smooth`: F = 2/3 K h at h deep. S0, what a contact must have to be as stiff as
/// its tissue, is that of a round burr of 1 mm in 16 um: a lone voxel is softer than a wall.
inline constexpr int kDepthPower = 2;                                                    // p
inline constexpr double kEnergyShare = (kDepthPower + 3.0) / (3.0 * (kDepthPower + 1));  // c
inline constexpr double kLeastSum = 4.6e-18;  // S0, m^(2 + p)

/// A contact's share t = s K a d^(p+1) / (sum(a d^p) + S0) of the normal force, which friction and
/// cutting take: never negative, and together 2/3 K h in that same contact.
inline constexpr double kShareOfForce = 2.0 * (kDepthPower + 2) / (3.0 * (kDepthPower + 1));  // s

/// dU/dd of a contact, t its share, w = a d^p and W the sum of those and S0:
///   kPushPerShare t - p (w / d) U / W.
inline constexpr double kPushPerShare = 0.5 * (kDepthPower + 3);

}  // namespace sulcus::potential
