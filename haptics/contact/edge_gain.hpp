#pragma once

#include <Eigen/Core>

namespace sulcus {

/// Sums over what is in contact or nearly so of weight, normal N and N N' (xx, xy, xz, yy, yz, zz);
/// the weight grows from zero where a voxel comes near to one where it is in contact.
struct NormalSpread {
  double weight = 0.0;
  double normal[3]{};
  double products[6]{};
};

/// How much of the way from a contact's normal to the tool's own direction its force turns: a
/// symmetric matrix with eigenvalues from 0 to 1, along which axis how much.
///
/// On a face and a gentle curve the normals of the surface agree, and the tool's directions, which
/// tell the voxels in contact apart by chance, are left alone. Across an edge there is no normal:
/// those of the two faces take turns as the tool goes round, within a tick or two, while the
/// direction from the edge to the tool's middle turns with it. So along each axis the tool's
/// direction counts by how the normals spread along that, their covariance C against what noise and
/// curvature make of it: C^2 / (C^2 + s^2), s = 0.05; that of two faces at right angles is up to
/// 0.5, of normals within 8 degrees 0.02. Not in the paper.
Eigen::Matrix3d edge_gain(const NormalSpread& spread) noexcept;

}  // namespace sulcus
