// The CPU stack in one include. Start reading at render/renderer.hpp.
#pragma once

#include "asperity/control/coupling_for.hpp"
#include "asperity/control/real_session.hpp"
#include "asperity/control/virtual_session.hpp"
#include "asperity/control/virtual_tool.hpp"
#include "asperity/hal/any_device.hpp"
#include "asperity/hal/simulated/simulated_device.hpp"
#include "asperity/render/default_renderer.hpp"
#include "asperity/render/field_renderer.hpp"
