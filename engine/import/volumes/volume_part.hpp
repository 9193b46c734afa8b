#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/import/volumes/medical_volume.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// Whether a scene asks for a part of its volume: a box, a label, or tissues by label.
bool names_a_part(const WorkpieceSettings& settings, std::span<const TissueSettings> tissues);

/// The part of `volume` that a scene asks for, cut out with a margin around it:
///
/// - `settings.box_file`: voxels whose centre lies in it;
/// - `settings.label`: voxels with that value of `labels`, or, where that is null, of `volume`;
/// - without `solid_above`, where tissues have labels: voxels with one of those.
///
/// All others that would be solid become air (of a mask or a label map: 0), and no value is
/// changed into another but that. Lattice spacing: `settings.spacing_m`, else the file's.
///
/// `labels` has to lie on the lattice of `volume`, whatever the order and sense of its own axes:
/// the same sizes, no corner further off than a tenth of a voxel; where a file knows no spacing
/// only its directions and sizes can be compared. `warnings`: values of a label map that no tissue
/// has, which are left out.
/// @throws InputError: another lattice, a label that is not there, a box without a voxel.
MedicalVolume take_part(MedicalVolume volume, const MedicalVolume* labels,
                        const WorkpieceSettings& settings, std::span<const TissueSettings> tissues,
                        std::vector<std::string>& warnings);

}  // namespace sulcus
