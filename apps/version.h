#pragma once

namespace plumbline {

// Returns the version of this build, such as "0.1.0".
const char* Version();

// Returns the git commit that was built, abbreviated, with "+" where files had been changed since;
// empty where the source was no git checkout.
const char* Commit();

}  // namespace plumbline
