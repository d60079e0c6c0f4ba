// The host's share after a submission: what the groups of a contact left becomes its penetration.
#pragma once

#include <span>

#include "asperity/render/penetration.hpp"
#include "job_writer.hpp"

namespace asperity::gl {

/// What a depth_backend reports for a contact whose jobs are done.
/// @param results  job::result_numbers per group, `groups` groups per job   @rt safe
[[nodiscard]] penetration read_back(const job_writer& writer, const number_list& results, std::size_t groups,
                                    const contact_jobs& place, const contact& c, const pose& T_wa) noexcept;

}  // namespace asperity::gl
