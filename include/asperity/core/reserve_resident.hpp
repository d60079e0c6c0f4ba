// Memory that a tick may use without waiting for the kernel.
#pragma once

#include <cstddef>
#include <vector>

namespace asperity::detail {

/// As v.reserve(count) for a vector that is still empty, and touches what it took. The kernel finds a page for reserved
/// memory at the first access, which would be in the first tick that needs that much.
template <class T>
void reserve_resident(std::vector<T>& v, std::size_t count) {
  v.resize(count);
  v.clear();
}

}  // namespace asperity::detail
