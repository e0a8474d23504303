#include "core/judging/static_frames.h"

#include <algorithm>
#include <utility>

namespace plumbline {
namespace {

constexpr char kUsualBody[] = "base_link";

std::string WithoutSlash(const std::string& name) {
  return name.substr(std::min(name.find_first_not_of('/'), name.size()));
}

struct Link {
  std::string parent;
  Rigid3d parent_from_child;
};
using Tree = std::map<std::string, Link>;  // by child

Tree TreeOf(const std::vector<Transform>& transforms) {
  Tree tree;
  for (const Transform& one : transforms) {
    const Eigen::Quaterniond rotation(
        one.rotation[3], one.rotation[0], one.rotation[1], one.rotation[2]);
    const Eigen::Vector3d translation(
        one.translation[0], one.translation[1], one.translation[2]);
    // A rotation that is none says nothing; the comparison fails for NaN, too.
    if (!(rotation.norm() > 0.5) || !translation.allFinite()) continue;
    tree[WithoutSlash(one.child)] = {WithoutSlash(one.parent),
                                     {rotation.normalized(), translation}};
  }
  return tree;
}

// A frame and those that carry it, up to the root.
std::vector<std::string> ChainOf(const Tree& tree, const std::string& frame) {
  std::vector<std::string> chain = {frame};
  for (auto link = tree.find(frame); link != tree.end();
       link = tree.find(link->second.parent)) {
    const std::string& parent = link->second.parent;
    if (std::find(chain.begin(), chain.end(), parent) != chain.end()) break;  // a ring
    chain.push_back(parent);
  }
  return chain;
}

bool Holds(const std::vector<std::string>& chain, const std::string& frame) {
  return std::find(chain.begin(), chain.end(), frame) != chain.end();
}

}  // namespace

StaticFrames FindStaticFrames(const std::vector<Transform>& transforms,
                              const std::vector<std::string>& frames) {
  const Tree tree = TreeOf(transforms);
  StaticFrames found;
  std::vector<std::pair<std::string, std::vector<std::string>>> chains;  // name as asked
  for (const std::string& frame : frames) {
    if (tree.count(WithoutSlash(frame)) == 0) continue;
    chains.emplace_back(frame, ChainOf(tree, WithoutSlash(frame)));
  }
  if (chains.empty()) return found;
  // The last that all chains hold is nearest to the root.
  for (const std::string& candidate : chains.front().second) {
    const bool carries_all =
        std::all_of(chains.begin(), chains.end(), [&candidate](const auto& chain) {
          return Holds(chain.second, candidate);
        });
    if (!carries_all) continue;
    found.body = candidate;
    if (candidate == kUsualBody) break;
  }
  if (found.body.empty()) return found;
  for (const auto& [name, chain] : chains) {
    Rigid3d body_from_frame;
    for (const std::string& frame : chain) {
      if (frame == found.body) break;
      body_from_frame = tree.at(frame).parent_from_child * body_from_frame;
    }
    found.body_from_frame[name] = body_from_frame;
  }
  return found;
}

}  // namespace plumbline
