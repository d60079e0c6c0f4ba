// asperity bake: the options that wrap a mesh in a closed surface, and what is reported of it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "asperity/bake/wrap.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "cli.hpp"

namespace asperity::command {

struct wrap_options {
  bool wanted = false;
  std::optional<double> cell_m;
  std::optional<double> thickness_m;
};

/// Adds the options to the subcommand; what they set stays valid as long as it.
/// @return --wrap
CLI::Option* add_wrap_options(CLI::App& sub, const std::shared_ptr<wrap_options>& options);

/// What a wrap did, for the document's key "wrap".
[[nodiscard]] json wrap_document(const bake::wrap_report& report);

/// The same in rows, for a person.
[[nodiscard]] std::string wrap_text(const bake::wrap_report& report);

/// A refusal of the mesh, with the command's way out of it where there is one.
[[nodiscard]] error with_offer_to_wrap(error refusal, bool can_be_wrapped);

}  // namespace asperity::command
