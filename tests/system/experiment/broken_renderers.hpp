// Renderers whose policies are broken, made as the workbench wants them.
#pragma once

#include "broken_mutation.hpp"
#include "workbench.hpp"

namespace broken {

/// What a variant of the paper's asks for, on the CPU, with the mutation; none is whole.
[[nodiscard]] asperity::result<asperity::any_renderer> make_renderer(asperity::scene bodies,
                                                                     const asperity::experiment::variant& kind,
                                                                     mutation how);

}  // namespace broken
