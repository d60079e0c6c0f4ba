// The two hand-overs between the contact thread and the device thread.
#pragma once

#include <cstdint>

#include "asperity/control/linear_contact.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/triple_buffer.hpp"

namespace asperity {

/// Where the probe was, and when.
struct timed_pose {
  pose T_wc{};  ///< the probe's centre-of-mass frame
  std::int64_t time_ns = 0;
};

/// Data goes round once: the device thread publishes poses, the contact thread publishes contacts. Neither waits.
struct exchange {
  triple_buffer<timed_pose> poses;         ///< written by the device thread
  triple_buffer<linear_contact> contacts;  ///< written by the contact thread
};

}  // namespace asperity
