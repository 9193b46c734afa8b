#pragma once

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// What dentists press with, held: 0.5, 1 and 2 N on flat faces at four tilts and at three sites of
/// the molar's sulcus, with round burrs and with a fissure and a flame burr on their tips and
/// sides, devices omni and touch, all hands, delay 0 and 1, spindle stopped and cutting; rows of
/// the case `clinical_pushes`, one for each burr and place with the worst of its settings, which
/// stands in the row. At the sites of the sulcus a burr is pressed where it comes to lie, and also
/// beside that, from where it slides there. `brief`: one device, hand and delay, two burrs, a face
/// and a site.
CaseResult clinical_pushes(bool brief);

/// A burr aslant turns the handle of a device that renders torques: rows of `pressed_off_axis`.
CaseResult pressed_off_axis(bool brief);

}  // namespace sulcus::lab
