#include <cmath>
#include <gtest/gtest.h>

namespace asperity { namespace {} }
