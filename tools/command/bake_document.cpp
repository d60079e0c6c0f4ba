#include "bake_document.hpp"

#include <utility>

#include "model_report.hpp"
#include "text.hpp"

namespace asperity::command {

answer report_bake(const finished_bake& done, std::vector<std::string> notes) {
  for (std::string& warning : warnings(done.model)) notes.push_back(std::move(warning));
  answer out;
  out.document = {{"file", done.file}, {"source", done.source}, {"scale", done.scale}};
  out.document.update(describe(done.model));
  out.document["repair"] = {{"holes_closed", done.holes.holes},
                            {"triangles_added", done.holes.triangles_added},
                            {"area_added", done.holes.area_added_m2},
                            {"largest_hole", done.holes.largest_m}};
  out.document["uvs"] = done.kept_uvs ? "kept" : "made";
  if (done.relief.relief) out.document["relief"] = done.relief.document;
  json stages = json::array();
  std::string times;
  double total = 0.0;
  for (const auto& [stage, seconds] : done.clock.stages()) {
    stages.push_back({{"stage", stage}, {"seconds", seconds}});
    times += (times.empty() ? "" : ", ") + stage + ' ' + time_text(seconds);
    total += seconds;
  }
  out.document["stages"] = std::move(stages);
  out.document["seconds"] = total;
  out.document["warnings"] = notes;
  out.document["units"] = "SI";
  out.text = printable(done.source + " -> " + done.file) + '\n' + describe_text(done.model);
  out.text += done.relief.text;
  if (done.holes.holes > 0) {
    out.text += row("holes closed", std::to_string(done.holes.holes) + ", the largest " +
                                        length_text(done.holes.largest_m) + " across");
  }
  out.text += row("time", time_text(total) + "  (" + times + ')') + warnings_text(notes);
  return out;
}

}  // namespace asperity::command
