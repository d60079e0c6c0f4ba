// Plants a bug in the text of a source: by function, and by what stands in it, token for token.
#pragma once

#include <string>

#include "asperity/core/status.hpp"
#include "workshop/mutation/catalogue.hpp"

namespace asperity::mutation {

/// The source with the bug in it. An operation is one of
///
///   body STATEMENTS           the function does this instead
///   negate CONDITION          of an if or a while
///   drop BEGINNING            the statement that begins like this, with what belongs to it
///   change TOKENS => TOKENS   of the declaration or the body
///   swap NAME I J             two arguments, from 1, of a call
///
/// What an operation names stands in the function exactly once, whatever the white space, the line breaks and the
/// comments; `#2` at its end (of what is left of the =>) takes the second. `in NAME #2` takes the second function so
/// named.
/// @return which function or element is not there, or is there more than once, or that nothing changed
[[nodiscard]] result<std::string> plant(const std::string& source, const bug& what);

}  // namespace asperity::mutation
