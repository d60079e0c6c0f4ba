// The CPU stack in one include. Start reading at render/renderer.hpp.
#pragma once

#include "asperity/control/real_session.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/control/virtual_session.hpp"
#include "asperity/control/virtual_tool.hpp"
#include "asperity/device/any_device.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
