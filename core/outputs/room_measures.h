#pragma once

#include <vector>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Fills in what a room with given loops measures: area, its standard deviation from the joint
// covariance of its walls, perimeter, height, clear dimensions and a place for its label.
void MeasureRoom(const PlaneCovariance& planes, const StoreyLevel& level, Room* room);

// The pieces of walls of which two rooms' edges, or two edges of one room, are the two faces,
// up to 0.6 m thick.
std::vector<WallPiece> FindWalls(const PlaneCovariance& planes,
                                 const StoreyLevel& level,
                                 const std::vector<Room>& rooms);

}  // namespace plumbline
