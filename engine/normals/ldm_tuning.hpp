#pragma once

#include <cstddef>
#include <cstdint>

namespace sulcus {

// The tuned constants of ldm and ldm_fast: lengths in voxels, ratios without a unit. How each was
// found: [q] from what quantisation alone does: residuals across a plane of tilt t are spread
// evenly over +-cos(t) / 2, with a root mean square of 0.289 cos(t); [p] with the prototype of the
// method, on sphere, cube, torus, molar and plates; [m] measured with `sulcus-lab normals`, mean
// errors in degrees at NS 6 (sphere, faces of the turned cube, molar ...), as said. What has none
// of these was set with the method and has no figures of its own.

// --- Maps ---------------------------------------------------------------------------------------

/// Steps from a column to the next that a trace follows [p]: keeps thin walls and edges.
inline constexpr int kMaxStep = 2;
/// |z(p) + z(-p) - 2 z(0)| in even rings, a test blind to tilt [p], and from kManyRings rings on:
/// an edge that only the outer ones reach is still little out of line, and tilts the fit. [m] of
/// ldm_fast: molar 1.17 with 3 throughout, 1.13 so; with 2 throughout the torus 1.08 -> 1.53.
inline constexpr int kMostUneven = 3, kMostUnevenOfMany = 2, kManyRings = 5;
/// Planes are not followed over columns that are steeper to them, by the cosine: the columns that
/// were not found, at kNone, are off every other.
inline constexpr float kLeastPlaneCosine = 0.2f;
/// Queries in a leaf for which a tile pays.
inline constexpr std::size_t kLeastQueriesForTile = 6;

/// Of estimates along equally dominant axes those count whose components along their own axes are
/// so near to the largest [m: a plane near (1, 1, 1) 0.78 with the mean of all, 0.45 so].
inline constexpr float kAsLevel = 0.005f;

// --- Whole maps ---------------------------------------------------------------------------------

/// A quadric explains a map whose largest residual is so far beyond cos / 2 [p, q], or of a map of
/// every other column whose largest is no more than that.
inline constexpr float kMapResidual = 0.35f, kWideMapResidual = 0.6f;
/// Largest cubic part of a surface over the columns at the rim of its map, of its quadratic part.
inline constexpr float kMostCubic = 0.2f;
/// Curvatures half a map out: of what is a face; of what may be one, where few terraces of a slope
/// near a whole number look curved [m: random planes 0.148 -> 0.117]; of a wide map's
/// face.
inline constexpr float kFaceCurvature = 0.2f, kApparentCurvature = 0.15f, kWideCurvature = 0.1f;
/// A map of every other column helps where terraces are wide: on level faces, and on curved
/// surfaces that are more level [m: sphere 0.2236 -> 0.2233, molar 1.026 -> 1.029]; a face is what
/// is curved by no more than so many times kFaceCurvature.
inline constexpr float kLevelFaceCosine = 0.98f, kLevelCurvedCosine = 0.995f, kNearlyFlat = 1.25f;
/// Slopes this near to whole numbers have wide terraces along diagonals of the grid, too [m: random
/// planes, as above].
inline constexpr float kNearWhole = 0.1f;
/// A face over a wide map: least share of its columns that are found, and how far they may be from
/// the first plane, beyond quantisation.
inline constexpr float kLeastShareFound = 0.6f, kMostOffFirstPlane = 0.8f;

// --- ldm_fast -----------------------------------------------------------------------------------

/// A map with no more even rings lies across an edge. [m] of three: torus 1.08 -> 1.18.
inline constexpr int kRingsAtEdge = 2;
/// Curvatures half a map out of what may be a face, and of what may be a level one [m: faces 0.175
/// -> 0.115, molar 1.174 -> 1.127, with kMostUnevenOfMany].
inline constexpr float kFastFaceCurvature = 0.15f, kFastLevelFaceCurvature = 0.5f;
/// Least NS for wide maps: what a smaller map sees is nearly all flat [m].
inline constexpr int kLeastForWide = 4;

// --- Balls --------------------------------------------------------------------------------------

/// Radii of the balls about a voxel, largest first, at NS 6 ([p] had 10, 6.5, 4.2, 2.6); the first
/// grows with NS. A voxel whose ball is no larger than kNearEdge is near to an edge [p].
inline constexpr float kBallRadii[] = {7.6f, 5.8f, 4.2f, 2.6f};
inline constexpr float kNearEdge = 3.0f;
/// A surface is rough where so many columns are out of line with two of their neighbours, by so
/// many voxels, and spread, as those along an edge do not: the smaller principal variance of their
/// places, columns^2. Quantised planes are at most one out of line. The ball's quadric then bends
/// by at most kMostRoughSagitta voxels up to its rim, and the mean square of its residuals is at
/// most kMostRoughScatter voxels^2. kLeastForRough: the least NS of a map that tells. [m: a sphere
/// in 0.4 voxels of noise 6.2 -> 0.7 degrees, rims of a cavity in the molar 3.021 -> 3.032; with a
/// variance of 3, 3.035.]
inline constexpr int kFewestOutOfLine = 5, kLeastForRough = 5;
inline constexpr std::int16_t kOutOfLine = 2;
inline constexpr std::int64_t kLeastSpread = 4;
inline constexpr float kMostRoughSagitta = 2.0f, kMostRoughScatter = 0.6f;
/// Fewest points in a ball, and share of them that a face which grows from it must have.
inline constexpr int kFewestPointsInBall = 12;
inline constexpr float kLeastShareGrown = 0.8f;
/// What explains points [q]: the largest residual beyond cos / 2, and the root mean square by the
/// cosine ([p] had 0.40 and 0.35).
struct ResidualTolerance {
  float beyond_half_cosine, rms_by_cosine;
};
inline constexpr ResidualTolerance kPlaneInBall{0.15f, 0.32f}, kQuadricInBall{0.27f, 0.35f};
/// Radius of the ball of the first plane [p], and its fewest columns.
inline constexpr float kCloseRadius = 3.6f, kFewestClose = 5.0f;

// --- Planes that grow ---------------------------------------------------------------------------

/// A column is on a plane up to so far beyond cos / 2; the plane holds with this root mean square
/// by the cosine [q].
inline constexpr float kGrownSlack = 0.1f, kGrownRms = 0.32f;
/// Bound of the analytic centre, by the largest residual: strictly above it.
inline constexpr float kCentreBound = 1.02f;

// --- Near edges: half-discs and sides of balls --------------------------------------------------

/// Radius of the half-discs [p], fewest columns in one ([p] had 24), and on a face that grows.
inline constexpr float kDiscRadius = 6.8f, kFewestInHalf = 40;
inline constexpr int kFewestOnGrown = 12;
/// What explains a half: as for balls.
inline constexpr ResidualTolerance kPlaneInHalf{0.4f, 0.35f};
/// How far the first plane may be from the voxel: fitting it again mends no more.
inline constexpr float kMostAway = 2.0f;
/// Offsets of a voxel's own face [p], its least cosine to the coarse normal (65 degrees: no face of
/// an edge or corner of 50 degrees or more is further), and what a column is worth beside a voxel
/// of distance [p].
inline constexpr float kMostInside = -0.25f, kMostOutside = 1.0f;
inline constexpr float kLeastCosineToCoarse = 0.42f, kScorePerColumn = 0.004f;
/// Scores this near to one another are equal: what chooses between them would be rounding.
inline constexpr float kEqualScore = 1e-4f;
/// Sides of balls: of how many halves, the best first, of which so large a share must lie on the
/// first plane; how far behind the voxel a side begins, where the voxel is inside a face and else;
/// radii; and what these are worth in the score. [m] of three halves, three radii and the side's
/// own rim: the rim of a hole of radius 9 voxels 20.7 -> 17.4, for 8 % more time.
inline constexpr std::size_t kMostSides = 3;
inline constexpr float kLeastShareInHalf = 0.8f;
inline constexpr float kBehindInside[] = {2.5f}, kBehindElse[] = {1.5f, 0.0f};
inline constexpr float kSideRadii[] = {6.8f, 3.8f};
inline constexpr float kScorePerBehind = 0.1f, kScorePerRadius = 0.05f;
/// Least component of the coarse normal, by its largest, along a second axis to look along [p:
/// edges of the cube 17 without, 11 with it].
inline constexpr float kSecondAxis = 0.55f;

// --- Fractions ----------------------------------------------------------------------------------
// Rounded to 1/255, heights of a plane scatter by 0.001 to 0.002.

/// Root mean square of the residuals, across the surface, of what is explained: the whole map, the
/// smaller windows about the voxel, and those aside [m: torus 0.097 degrees with 0.012 about the
/// voxel, 0.073 so]. A window that scatters by no more than kMoreThanNoise of the square of the
/// smallest, and that by no more than kMostNoise, is no edge.
inline constexpr float kWholeResidual = 0.005f, kWindowResidual = 0.004f, kSideResidual = 0.02f,
                       kSettled = 0.05f, kMoreThanNoise = 1.5f, kMostNoise = 0.15f;
/// Up to which residual a window may be a face; what a residual and a column aside are worth beside
/// a voxel of distance: far windows reach around bends [m: molar 0.50 degrees with 0.03 a column,
/// 0.39 so; edges of the cube 1.0 and 2.0].
inline constexpr float kNearlyExplained = 0.4f, kPerResidual = 15.0f, kPerStep = 0.3f;
/// Least cosines of a face to its columns and to the coarse normal, and least component of the
/// coarse normal, by its largest, along an axis to look along.
inline constexpr float kLeastFilledCosine = 0.15f, kLeastFilledCosineToCoarse = 0.3f,
                       kOtherAxis = 0.2f;
/// Least component of a normal along an axis whose own column counts; and how far, in voxels, its
/// columns may be off a surface that is as they say.
inline constexpr float kLeastOwnAxis = 0.35f, kSameOffset = 0.015f;
/// Faces are equally near within the heights' noise.
inline constexpr float kEqualFace = 1e-3f;

// --- The tool -----------------------------------------------------------------------------------

/// Squared cosine from which on a coarse normal that points away from the tool is on the far side
/// of a wall (120 degrees). [m] with 90 degrees: errors up to 141 degrees at concave edges.
inline constexpr float kFarSideCosine2 = 0.25f;

}  // namespace sulcus
