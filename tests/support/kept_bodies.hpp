// The default renderer for tests that feel the same bodies again and again.
#pragma once

#include "asperity/least_motion/least_motion_renderer.hpp"

namespace asperity::test_support {

/// make_renderer(), which keeps what it made of the last few scenes for who asks for them again with other settings.
[[nodiscard]] result<least_motion_renderer> build_renderer(scene bodies,
                                                           const least_motion_renderer_settings& settings = {});

}  // namespace asperity::test_support
