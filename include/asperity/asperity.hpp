// The CPU stack in one include. Start reading at render/renderer.hpp.
#pragma once

#include "asperity/render/renderer.hpp"
