// The page's own files, as the build put them into the program.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "view/scene_document.hpp"

namespace asperity::view {

struct page_file {
  std::string_view path;  ///< where a browser asks for it: "/page.css"
  std::string_view type;  ///< Content-Type
  std::string_view bytes;
};

/// The page itself comes first, its scripts in the order in which they build on each other.
[[nodiscard]] std::span<const page_file> page_files() noexcept;

/// The page of a device, and what it has beside the files of the other page.
[[nodiscard]] std::span<const page_file> panel_files() noexcept;

/// The page with everything that it shows, as one file that needs no server and no network.
[[nodiscard]] std::string export_page(const page_content& content);

}  // namespace asperity::view
