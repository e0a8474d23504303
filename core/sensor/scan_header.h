#pragma once

#include <string>

#include "core/recording/messages.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Corrects the header of a scan line before anything is made of it: takes the rig file's time
// increment and angles instead of the message's where it states them, and brings beams that
// were taken in the reverse of their order (a negative time increment) into the order of their
// times, the stamp with them. scanner: nullptr where there is no rig file.
void CorrectHeader(const Scanner* scanner, ScanLineMessage* message);

// Why a scan line is not usable, in words: "time_increment is 0.5 s, so that ..."; where it
// would make sense in another unit, which.
std::string WhyUnusable(const ScanLineMessage& message);

// Whether a range is the largest one that the driver states to measure, which many drivers
// give where there is no return: within a thousandth of it. Ranges beyond are not judged;
// there are drivers that state less than they measure.
bool IsStatedLimit(const ScanLineMessage& message, float range);

}  // namespace plumbline
