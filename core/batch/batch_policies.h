#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The rules by which the batch changes associations, a function each. Functions called Drop...
// take all observations from the landmarks that they judge to be no planes
// (ReleaseObservations), and return how many observations.

// Associates every observation anew with the landmarks as they are estimated now, at the
// covariance of its scan's pose: taken as known exactly, a pose that is off keeps away the
// very segments that would correct it. Returns how many observations changed. An observation
// loses a landmark of which nothing else has been seen near it: the plane's first, uncertain
// estimate took it in, and far away from all others it would hold the plane there for good.
int Reassociate(const Rig& rig,
                const MapperOptions& options,
                const PoseCovarianceAt& pose_covariance,
                MapState* state);

// Merges landmarks that turn out to be one surface (FindMergeable) and do not lie apart where
// they are seen together (LieApart). Returns the ids of the landmarks that others were merged
// into, one entry for each of the others. Pairs (older, newer) that were found to be two
// surfaces are left apart.
std::vector<int> MergePlanes(const Rig& rig,
                             const MapperOptions& options,
                             const std::set<std::pair<int, int>>& apart,
                             MapState* state);

// Drops landmarks that their own segments contradicted while the rig was followed: oblique
// false planes across corners. Where the noise is larger than the rig file states, the
// segments of all planes deviate, and a landmark is compared with their mean.
int DropContradictedPlanes(MapState* state);

// Drops landmarks that only repeat one with more points (IsRedundant) and meet it (Meet),
// unless the two were found to be two surfaces (apart).
int DropRedundantPlanes(const Rig& rig,
                        const MapperOptions& options,
                        const std::set<std::pair<int, int>>& apart,
                        MapState* state);

// Drops landmarks that beams of other landmarks pass through (FindPassedThrough).
int DropPassedThrough(const Rig& rig, MapState* state);

// Makes walls cylinders whose segments show that they bend (BendTest), all but the one that
// fixes the gauge, and cylinders walls where they do not. Returns how many segments lie on
// them.
int BendWalls(const Rig& rig, const AssociationOptions& options, MapState* state);

// Makes rows of narrow walls cylinders that they are chords of (FindRowsOfChords). Returns how
// many segments lie on them.
int BendRowsOfChords(const Rig& rig, const AssociationOptions& options, MapState* state);

// Drops general planes whose segments do not determine their normals, or another one than they
// have; those that their segments show to be upright or level become vertical or horizontal.
int DecideGeneralPlanes(const Rig& rig, const AssociationOptions& options, MapState* state);

// Drops landmarks that fewer scans support, by segments of two beams or more, than a new plane
// needs. The observations are in the order of time.
int DropWeakPlanes(const PlaneOptions& options, MapState* state);

// Drops landmarks of whose segments only single beams are left, which determine no direction.
int DropPlanesWithoutLines(MapState* state);

// Drops cylinders whose estimate has left no circle: the walls that they were taken for are
// none, and no radius can be stated of them. Their sub-minimum segments are removed, too.
int DropVanishedCylinders(MapState* state);

// Drops landmarks that hold many points in sub-minimum segments and few in segments, as
// oblique false planes across corners do; their sub-minimum segments are removed, too.
int DropObliqueFalsePlanes(MapState* state);

}  // namespace plumbline
