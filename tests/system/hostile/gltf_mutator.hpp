// Changes a glTF document at random and keeps its structure: what comes out is still a .glb with JSON in it, so that
// mutations reach the checks behind the first one.
#pragma once

#include <string>

#include "random_source.hpp"

namespace asperity::hostile {

/// One to three changes of a .glb: numbers, names and types in the JSON, objects swapped, doubled and dropped, nesting,
/// bytes of the BIN chunk, and once in a while the envelope.
[[nodiscard]] std::string mutated_glb(const std::string& glb, random_source& random);

}  // namespace asperity::hostile
