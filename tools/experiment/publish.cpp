#include "publish.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "output_file.hpp"
#include "text.hpp"

namespace asperity::experiment {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

result<void> write_file(const fs::path& file, std::string_view bytes) {
  result<command::output_file> opened = command::output_file::create(file);
  if (!opened) return opened.error();
  if (const result<void> written = opened->write(bytes); !written) return written;
  return opened->commit();
}

result<void> write_figure(const figure& f, const fs::path& folder) {
  for (const auto& [extension, format] :
       {std::pair{".svg", command::plot_format::svg}, std::pair{".png", command::plot_format::png}}) {
    result<command::output_file> opened = command::output_file::create(folder / (f.name + extension));
    if (!opened) return opened.error();
    if (const result<void> drawn = command::draw(f.page, format, *opened); !drawn) return drawn;
    if (const result<void> closed = opened->commit(); !closed) return closed;
  }
  return {};
}

std::string to_csv(const table& t) {
  std::string out;
  for (std::size_t i = 0; i < t.columns.size(); ++i) out += (i == 0 ? "" : ",") + t.columns[i];
  out += '\n';
  for (const std::vector<double>& row : t.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) out += ',';
      command::append_number(out, row[i]);
    }
    out += '\n';
  }
  return out;
}

// JSON has no word for a number that is not finite: null.
json number(double v) { return std::isfinite(v) ? json(v) : json(); }

const char* to_string(relation is) noexcept {
  switch (is) {
    case relation::at_most:
      return "at_most";
    case relation::at_least:
      return "at_least";
    case relation::between:
      return "between";
  }
  return "unknown";
}

}  // namespace

json to_json(const published& one) {
  json statements = json::array();
  bool pass = !one.found.statements.empty();
  for (const statement& s : one.found.statements) {
    pass = pass && s.holds();
    json bound = number(s.bound);
    if (s.is == relation::between) bound = {number(s.bound), number(s.upper_bound)};
    statements.push_back({{"name", s.name},
                          {"claim", s.claim},
                          {"value", number(s.value)},
                          {"relation", to_string(s.is)},
                          {"bound", std::move(bound)},
                          {"pass", s.holds()}});
  }
  return {{"experiment", one.what->name},
          {"title", one.what->title},
          {"pass", pass},
          {"statements", std::move(statements)},
          {"notes", one.found.notes}};
}

result<void> write_findings(const published& one, const fs::path& out) {
  const fs::path folder = out / one.what->name;
  if (const result<void> made = command::make_folder(folder); !made) return made;
  // One of an earlier run must not stand beside files of this one.
  std::error_code ignored;
  fs::remove(folder / "verdict.json", ignored);
  for (const table& t : one.found.tables) {
    if (const result<void> written = write_file(folder / (t.name + ".csv"), to_csv(t)); !written) return written;
  }
  for (const figure& f : one.found.figures) {
    if (const result<void> written = write_figure(f, folder); !written) return written;
  }
  return write_file(folder / "verdict.json", to_json(one).dump(2) + "\n");
}

std::string bound_text(const statement& s) {
  switch (s.is) {
    case relation::at_most:
      return "at most " + command::brief(s.bound);
    case relation::at_least:
      return "at least " + command::brief(s.bound);
    case relation::between:
      return command::brief(s.bound) + " to " + command::brief(s.upper_bound);
  }
  return {};
}

}  // namespace asperity::experiment
