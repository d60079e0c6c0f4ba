// The report: one HTML file with everything in it.
#include <string>

#include "output_file.hpp"
#include "publish.hpp"

namespace asperity::experiment {

result<void> write_page(std::span<const published> all, const std::filesystem::path& out) {
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>asperity: experiments</title>";
  for (const published& one : all) page += std::string("<h2>") + one.what->title + "</h2>\n";
  result<command::output_file> opened = command::output_file::create(out / "index.html");
  if (!opened) return opened.error();
  if (const result<void> written = opened->write(page); !written) return written;
  return opened->commit();
}

}  // namespace asperity::experiment
